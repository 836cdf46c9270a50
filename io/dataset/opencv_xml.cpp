#include "io/dataset/opencv_xml.hpp"

#include <fmt/core.h>

#include <opencv2/core.hpp>

#include "geometry/fields.hpp"
#include "io/config/config_values.hpp"
#include "io/text_file.hpp"

namespace stillkite {
namespace {

ConfigNode converted(const cv::FileNode& from, const std::string& origin) {
  ConfigNode to{.origin = origin};
  if (from.isMap()) {
    to.kind = ConfigNode::Kind::map;
    for (const cv::FileNode child : from) {
      to.entries.emplace_back(child.name(), converted(child, origin));
    }
  } else if (from.isSeq()) {
    to.kind = ConfigNode::Kind::list;
    for (const cv::FileNode child : from) to.items.push_back(converted(child, origin));
  } else if (!from.isNone()) {
    to.kind = ConfigNode::Kind::scalar;
    to.text = from.isInt()    ? fmt::format("{}", static_cast<int>(from))
              : from.isReal() ? print_number(static_cast<double>(from))
                              : static_cast<std::string>(from);
  }
  return to;
}

}  // namespace

bool is_xml(const std::filesystem::path& file) {
  const std::string text = read_text_file(file);
  const std::size_t first = text.find_first_not_of("\xef\xbb\xbf \t\r\n");
  return first != std::string::npos && text[first] == '<';
}

ConfigNode read_opencv_xml(const std::filesystem::path& file) {
  try {
    const cv::FileStorage storage(read_text_file(file), cv::FileStorage::READ |
                                                            cv::FileStorage::MEMORY |
                                                            cv::FileStorage::FORMAT_XML);
    return converted(storage.root(), file.string());
  } catch (const cv::Exception& error) {
    throw InputError(
        fmt::format("{}: not an XML file of OpenCV's FileStorage: {}", file.string(), error.err));
  }
}

}  // namespace stillkite
