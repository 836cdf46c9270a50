#include <sqlite3.h>

#include <memory>
#include <string>

#include "geometry/fields.hpp"
#include "io/import/rosbag.hpp"

namespace stillkite {
namespace {

struct CloseDatabase {
  void operator()(sqlite3* database) const { sqlite3_close(database); }
  void operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }
};

std::string_view text_column(sqlite3_stmt* row, int column) {
  const unsigned char* text = sqlite3_column_text(row, column);
  if (text == nullptr) return {};
  return {reinterpret_cast<const char*>(text),
          static_cast<std::size_t>(sqlite3_column_bytes(row, column))};
}

}  // namespace

std::size_t read_ros_database(const std::filesystem::path& file, const TakeRosMessage& take) {
  sqlite3* opened = nullptr;
  const int status = sqlite3_open_v2(file.string().c_str(), &opened, SQLITE_OPEN_READONLY, nullptr);
  const std::unique_ptr<sqlite3, CloseDatabase> database(opened);
  sqlite3_stmt* prepared = nullptr;
  constexpr const char* kQuery =
      "SELECT topics.name, topics.type, messages.timestamp, messages.data FROM messages "
      "JOIN topics ON topics.id = messages.topic_id WHERE topics.serialization_format = 'cdr' "
      "ORDER BY messages.timestamp";
  if (status != SQLITE_OK ||
      sqlite3_prepare_v2(database.get(), kQuery, -1, &prepared, nullptr) != SQLITE_OK) {
    throw InputError(file.string() +
                     ": a database, but no ROS 2 bag: " + sqlite3_errmsg(database.get()));
  }
  const std::unique_ptr<sqlite3_stmt, CloseDatabase> row(prepared);
  int step = SQLITE_DONE;
  while ((step = sqlite3_step(row.get())) == SQLITE_ROW) {
    const std::string topic(text_column(row.get(), 0)), type = ros1_type(text_column(row.get(), 1));
    const auto* data = static_cast<const std::uint8_t*>(sqlite3_column_blob(row.get(), 3));
    const auto bytes = static_cast<std::size_t>(sqlite3_column_bytes(row.get(), 3));
    take({.topic = topic,
          .type = type,
          .logged =
              time_of_recording(static_cast<std::uint64_t>(sqlite3_column_int64(row.get(), 2))),
          .data = {data, data == nullptr ? 0 : bytes},
          .is_cdr = true});
  }
  return step == SQLITE_DONE ? 0 : 1;
}

}  // namespace stillkite
