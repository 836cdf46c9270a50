#include <fmt/core.h>

#include <charconv>
#include <cstdlib>

#include "io/dataset/table_reader.hpp"

namespace stillkite {
namespace {

// Value = digits * 10^exponent.
struct Decimal {
  bool negative = false;
  std::string digits;
  int exponent = 0;
};

std::optional<Decimal> parse_decimal(std::string_view text) {
  constexpr std::size_t kMaxLength = 64;
  if (text.empty() || text.size() > kMaxLength) return std::nullopt;
  Decimal out;
  out.negative = text[0] == '-';
  if (text[0] == '-' || text[0] == '+') text.remove_prefix(1);
  const std::size_t e = text.find_first_of("eE");
  if (e != std::string_view::npos) {
    std::string_view power = text.substr(e + 1);
    if (power.starts_with('+')) power.remove_prefix(1);
    const auto [end, error] =
        std::from_chars(power.data(), power.data() + power.size(), out.exponent);
    if (error != std::errc() || end != power.data() + power.size()) return std::nullopt;
    if (std::abs(out.exponent) > 100) return std::nullopt;
    text = text.substr(0, e);
  }
  bool after_point = false;
  for (const char c : text) {
    if (c == '.' && !after_point) {
      after_point = true;
    } else if (c >= '0' && c <= '9') {
      out.digits += c;
      out.exponent -= after_point ? 1 : 0;
    } else {
      return std::nullopt;
    }
  }
  if (out.digits.empty()) return std::nullopt;
  return out;
}

}  // namespace

std::optional<Timestamp> parse_stamp(std::string_view text, int unit_exponent) {
  const std::optional<Decimal> decimal = parse_decimal(text);
  if (!decimal) return std::nullopt;
  const int shift = decimal->exponent + unit_exponent;
  std::string digits = decimal->digits;
  bool round_up = false;
  if (shift >= 0) {
    digits.append(static_cast<std::size_t>(shift), '0');
  } else {
    const auto cut = static_cast<std::size_t>(-shift);
    if (cut > digits.size()) return Timestamp{0};
    round_up = digits[digits.size() - cut] >= '5';
    digits.erase(digits.size() - cut);
  }
  std::int64_t value = 0;
  if (!digits.empty()) {
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (error != std::errc()) return std::nullopt;
  }
  // a quarter of the range, so that differences of stamps do not overflow
  constexpr std::int64_t kMax = std::numeric_limits<std::int64_t>::max() / 4;
  if (value > kMax) return std::nullopt;
  value += round_up ? 1 : 0;
  return Timestamp{decimal->negative ? -value : value};
}

bool has_fraction(std::string_view number) {
  const std::optional<Decimal> decimal = parse_decimal(number);
  if (!decimal || decimal->exponent >= 0) return false;
  const auto decimals = static_cast<std::size_t>(-decimal->exponent);
  const std::string& digits = decimal->digits;
  const std::size_t point = decimals < digits.size() ? digits.size() - decimals : 0;
  return digits.find_first_not_of('0', point) != std::string::npos;
}

std::string print_seconds(Timestamp stamp) {
  const std::int64_t whole = stamp.ns / 1'000'000'000;
  const std::int64_t rest = std::abs(stamp.ns % 1'000'000'000);
  return fmt::format("{}{}.{:09}", stamp.ns < 0 ? "-" : "", std::abs(whole), rest);
}

}  // namespace stillkite
