#pragma once

#include <gtest/gtest.h>
#include <sqlite3.h>

#include <filesystem>

#include "tests/io/import/ros_samples.hpp"

namespace stillkite::samples {

/// ROS 2 bag in sqlite3.
inline void write_ros_database(const std::filesystem::path& file) {
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open(file.string().c_str(), &database), SQLITE_OK);
  sqlite3_exec(database,
               "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT, type TEXT, "
               "serialization_format TEXT);"
               "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER, "
               "data BLOB);",
               nullptr, nullptr, nullptr);
  std::int64_t time = 0;
  for (const RosSample& message : ros_messages(true)) {
    const std::string topic = "INSERT INTO topics(name, type, serialization_format) SELECT '" +
                              message.topic + "', 'sensor_msgs/msg/" + message.type +
                              "', 'cdr' WHERE NOT EXISTS (SELECT 1 FROM topics WHERE name = '" +
                              message.topic + "');";
    sqlite3_exec(database, topic.c_str(), nullptr, nullptr, nullptr);
    const std::string insert =
        "INSERT INTO messages(topic_id, timestamp, data) SELECT id, ?, ? FROM topics WHERE name = "
        "'" +
        message.topic + "'";
    sqlite3_stmt* row = nullptr;
    ASSERT_EQ(sqlite3_prepare_v2(database, insert.c_str(), -1, &row, nullptr), SQLITE_OK);
    sqlite3_bind_int64(row, 1, ++time);
    sqlite3_bind_blob(row, 2, message.bytes.data(), static_cast<int>(message.bytes.size()),
                      nullptr);
    sqlite3_step(row);
    sqlite3_finalize(row);
  }
  sqlite3_close(database);
}

}  // namespace stillkite::samples
