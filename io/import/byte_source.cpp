#include "io/import/byte_source.hpp"

#include <cerrno>
#include <string>

#include "geometry/fields.hpp"

namespace stillkite {
namespace {

constexpr std::size_t kBufferBytes = std::size_t{1} << 16;

}  // namespace

ByteSource::ByteSource(const std::filesystem::path& file)
    : stream_(file, std::ios::binary), buffer_(kBufferBytes) {
  if (!stream_) throw InputError(file.string() + ": cannot be read: " + std::strerror(errno));
}

Bytes ByteSource::peek(std::size_t count) {
  count = std::min(count, buffer_.size());
  if (end_ - begin_ < count) {
    std::copy(buffer_.begin() + static_cast<std::ptrdiff_t>(begin_),
              buffer_.begin() + static_cast<std::ptrdiff_t>(end_), buffer_.begin());
    end_ -= begin_;
    begin_ = 0;
    stream_.read(reinterpret_cast<char*>(buffer_.data() + end_),
                 static_cast<std::streamsize>(buffer_.size() - end_));
    end_ += static_cast<std::size_t>(stream_.gcount());
  }
  return Bytes(buffer_).subspan(begin_, std::min(count, end_ - begin_));
}

bool ByteSource::read(std::vector<std::uint8_t>& out, std::size_t count) {
  out.clear();
  while (out.size() < count) {
    const Bytes part = peek(std::min(count - out.size(), buffer_.size()));
    if (part.empty()) return false;
    out.insert(out.end(), part.begin(), part.end());
    skip(part.size());
  }
  return true;
}

void ByteSource::skip(std::uint64_t count) {
  const std::uint64_t buffered = std::min<std::uint64_t>(count, end_ - begin_);
  begin_ += static_cast<std::size_t>(buffered);
  if (count > buffered) {  // a damaged length may exceed every file offset
    constexpr std::uint64_t kMaxSeek_bytes = std::uint64_t{1} << 62;
    stream_.seekg(static_cast<std::streamoff>(std::min(count - buffered, kMaxSeek_bytes)),
                  std::ios::cur);
  }
}

}  // namespace stillkite
