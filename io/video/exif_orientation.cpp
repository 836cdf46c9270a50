#include "io/video/exif_orientation.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cstdint>
#include <string_view>

#include "geometry/fields.hpp"

namespace stillkite {
namespace {

using Bytes = std::span<const unsigned char>;

// Unsigned integer at an offset; 0 beyond the end.
std::size_t integer_at(Bytes bytes, std::size_t at, int size, bool big_endian) {
  if (at > bytes.size() || bytes.size() - at < static_cast<std::size_t>(size)) return 0;
  std::size_t value = 0;
  for (int i = 0; i < size; ++i) {
    value |= std::size_t{bytes[at + i]} << (8 * (big_endian ? size - 1 - i : i));
  }
  return value;
}

bool has_text_at(Bytes bytes, std::size_t at, std::string_view text) {
  return at <= bytes.size() && bytes.size() - at >= text.size() &&
         std::equal(
             text.begin(), text.end(), bytes.begin() + static_cast<std::ptrdiff_t>(at),
             [](char c, unsigned char byte) { return static_cast<unsigned char>(c) == byte; });
}

Bytes slice(Bytes bytes, std::size_t at, std::size_t size) {
  if (at >= bytes.size()) return {};
  return bytes.subspan(at, std::min(size, bytes.size() - at));
}

constexpr std::string_view kExifHeader{"Exif\0\0", 6};

// APP1 segment of a JPEG file, before the coded image.
Bytes exif_of_jpeg(Bytes file) {
  constexpr unsigned char kApp1 = 0xE1, kStartOfScan = 0xDA;
  for (std::size_t at = 2; at + 4 <= file.size() && file[at] == 0xFF;) {
    const unsigned char marker = file[at + 1];
    const std::size_t size = integer_at(file, at + 2, 2, true);
    if (marker == kStartOfScan) break;
    if (marker == kApp1 && has_text_at(file, at + 4, kExifHeader)) {
      return slice(file, at + 10, size - std::min<std::size_t>(size, 8));
    }
    at += marker == 0xFF ? 1 : 2 + size;
  }
  return {};
}

// eXIf chunk of a PNG file: size, type, data, checksum.
Bytes exif_of_png(Bytes file) {
  for (std::size_t at = 8; at + 8 <= file.size();) {
    const std::size_t size = integer_at(file, at, 4, true);
    if (has_text_at(file, at + 4, "eXIf")) return slice(file, at + 8, size);
    at += 12 + size;
  }
  return {};
}

// EXIF chunk of a WebP file: type, size, data, padded to an even size.
Bytes exif_of_webp(Bytes file) {
  for (std::size_t at = 12; at + 8 <= file.size();) {
    const std::size_t size = integer_at(file, at + 4, 4, false);
    if (has_text_at(file, at, "EXIF")) {
      const std::size_t header = has_text_at(file, at + 8, kExifHeader) ? kExifHeader.size() : 0;
      return slice(file, at + 8 + header, size - std::min(size, header));
    }
    at += 8 + size + size % 2;
  }
  return {};
}

Bytes exif_of(Bytes file) {
  if (has_text_at(file, 0, "\xFF\xD8")) return exif_of_jpeg(file);
  if (has_text_at(file, 0, "\x89PNG")) return exif_of_png(file);
  if (has_text_at(file, 0, "RIFF") && has_text_at(file, 8, "WEBP")) return exif_of_webp(file);
  return is_tiff(file) ? file : Bytes{};
}

}  // namespace

bool is_tiff(Bytes file) {
  return has_text_at(file, 0, {"II*\0", 4}) || has_text_at(file, 0, {"MM\0*", 4});
}

int exif_orientation(Bytes file) {
  constexpr std::size_t kOrientation = 0x0112;
  const Bytes exif = exif_of(file);  // a TIFF header and its first directory
  const bool big_endian = has_text_at(exif, 0, "MM");
  if (!big_endian && !has_text_at(exif, 0, "II")) return 1;
  const std::size_t directory = integer_at(exif, 4, 4, big_endian);
  const std::size_t entries = integer_at(exif, directory, 2, big_endian);
  for (std::size_t i = 0; i < entries; ++i) {
    const std::size_t entry = directory + 2 + 12 * i;
    if (entry >= exif.size()) break;
    if (integer_at(exif, entry, 2, big_endian) != kOrientation) continue;
    const std::size_t orientation = integer_at(exif, entry + 8, 2, big_endian);
    return orientation >= 1 && orientation <= 8 ? static_cast<int>(orientation) : 1;
  }
  return 1;
}

cv::RotateFlags exif_rotation(int orientation) {
  if (orientation == 3) return cv::ROTATE_180;
  return orientation == 6 ? cv::ROTATE_90_CLOCKWISE : cv::ROTATE_90_COUNTERCLOCKWISE;
}

void reject_mirrored(int orientation, const std::string& name) {
  if (orientation == 1 || orientation == 3 || orientation == 6 || orientation == 8) return;
  throw InputError(
      fmt::format("{}: EXIF orientation {} mirrors the image, which inverts the motion field; "
                  "remove the tag from the files",
                  name, orientation));
}

}  // namespace stillkite
