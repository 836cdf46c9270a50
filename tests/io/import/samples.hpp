#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "tests/io/import/byte_writer.hpp"

// Small recordings in each format. All describe the same instant: level, nose to the north, at rest
// 5 m above the ground at 47 deg north, 8 deg east, moving at 1 m/s north, 2 m/s east, 3 m/s down,
// angular rate (0.1, 0.2, 0.3) rad/s in FRD, ten readings at 100 Hz from 1 s.

namespace stillkite::samples {

inline constexpr int kReadings = 10;
inline constexpr std::uint64_t kFirst_us = 1'000'000, kStep_us = 10'000;

[[nodiscard]] inline std::string ulog() {
  ByteWriter out;
  const auto message = [&](char type, const std::string& bytes) {
    out.little(static_cast<std::uint16_t>(bytes.size())).little(type).text(bytes);
  };
  const auto subscribe = [&](std::uint16_t id, std::string_view name) {
    message('A', ByteWriter{}.little(std::uint8_t{0}).little(id).text(name).bytes);
  };
  out.text(std::string_view("ULog\x01\x12\x35\x01", 8)).little(std::uint64_t{0});
  message('F', "inner:uint8_t a;uint16_t b;");
  message('F',
          "sensor_combined:uint64_t timestamp;inner[2] nested;float[3] gyro_rad;"
          "int32_t accelerometer_timestamp_relative;float[3] accelerometer_m_s2;");
  message('F', "vehicle_attitude:uint64_t timestamp;uint64_t timestamp_sample;float[4] q;");
  message('F',
          "sensor_gps:uint64_t timestamp;double latitude_deg;double longitude_deg;"
          "double altitude_msl_m;float vel_n_m_s;float vel_e_m_s;float vel_d_m_s;"
          "uint8_t fix_type;bool vel_ned_valid;");
  message('F', "vehicle_air_data:uint64_t timestamp;float baro_alt_meter;");
  message('F',
          "distance_sensor:uint64_t timestamp;float current_distance;uint8_t orientation;"
          "int8_t signal_quality;");
  subscribe(7, "sensor_combined");
  subscribe(8, "vehicle_attitude");
  subscribe(9, "sensor_gps");
  subscribe(10, "vehicle_air_data");
  subscribe(11, "distance_sensor");
  for (int i = 0; i < kReadings; ++i) {
    const std::uint64_t t_us = kFirst_us + static_cast<std::uint64_t>(i) * kStep_us;
    const auto data = [&](std::uint16_t id) { return ByteWriter{}.little(id).little(t_us); };
    message('D', data(7)
                     .text("......")
                     .little(0.1f)
                     .little(0.2f)
                     .little(0.3f)
                     .little(std::int32_t{0})
                     .little(0.0f)
                     .little(0.0f)
                     .little(-9.80665f)
                     .bytes);
    message('D', ByteWriter{}
                     .little(std::uint16_t{8})
                     .little(t_us + 500)
                     .little(t_us)
                     .little(1.0f)
                     .little(0.0f)
                     .little(0.0f)
                     .little(0.0f)
                     .bytes);
    message('D', data(9)
                     .little(47.0)
                     .little(8.0)
                     .little(400.0)
                     .little(1.0f)
                     .little(2.0f)
                     .little(3.0f)
                     .little(std::uint8_t{3})
                     .little(std::uint8_t{1})
                     .bytes);
    message('D', data(10).little(400.0f).bytes);
    message('D', data(11).little(5.0f).little(std::uint8_t{25}).little(std::int8_t{100}).bytes);
  }
  return out.bytes;
}

[[nodiscard]] inline std::string dataflash() {
  ByteWriter out;
  const auto define = [&](std::uint8_t id, std::uint8_t bytes, std::string_view name,
                          std::string_view format, std::string_view labels) {
    out.text("\xa3\x95\x80")
        .little(id)
        .little(bytes)
        .text(name, 4)
        .text(format, 16)
        .text(labels, 64);
  };
  const auto begin = [&](std::uint8_t id, std::uint64_t t_us) -> ByteWriter& {
    return out.text("\xa3\x95").little(id).little(t_us);
  };
  define(1, 3 + 8 + 1 + 24, "IMU", "QBffffff", "TimeUS,I,GyrX,GyrY,GyrZ,AccX,AccY,AccZ");
  define(2, 3 + 8 + 8, "ATT", "QccccC", "TimeUS,Roll,Pitch,DesYaw,Other,Yaw");
  define(2, 3 + 8 + 6, "ATT", "QccC", "TimeUS,Roll,Pitch,Yaw");
  define(3, 3 + 8 + 1 + 12 + 12, "GPS", "QBLLefff", "TimeUS,Status,Lat,Lng,Alt,Spd,GCrs,VZ");
  define(4, 3 + 8 + 4, "BARO", "Qf", "TimeUS,Alt");
  define(5, 3 + 8 + 2 + 1, "RFND", "QCB", "TimeUS,Dist,Orient");
  for (int i = 0; i < kReadings; ++i) {
    const std::uint64_t t_us = kFirst_us + static_cast<std::uint64_t>(i) * kStep_us;
    begin(1, t_us)
        .little(std::uint8_t{0})
        .little(0.1f)
        .little(0.2f)
        .little(0.3f)
        .little(0.0f)
        .little(0.0f)
        .little(-9.80665f);
    begin(2, t_us).little(std::int16_t{0}).little(std::int16_t{0}).little(std::uint16_t{0});
    begin(3, t_us)
        .little(std::uint8_t{3})
        .little(std::int32_t{470'000'000})
        .little(std::int32_t{80'000'000})
        .little(std::int32_t{40'000})
        .little(2.236068f)
        .little(63.434949f)
        .little(3.0f);
    begin(4, t_us).little(400.0f);
    begin(5, t_us).little(std::uint16_t{500}).little(std::uint8_t{25});
  }
  return out.bytes;
}

/// Packet of MAVLink 1, or 2 without the zeros at its end.
[[nodiscard]] inline std::string mavlink(int version, std::uint8_t message, std::uint8_t seed,
                                         std::string payload, std::uint8_t component = 1) {
  ByteWriter head;
  if (version == 1) {
    head.little(static_cast<std::uint8_t>(payload.size())).text(std::string_view("\x05\x01", 2));
  } else {
    while (payload.size() > 1 && payload.back() == '\0') payload.pop_back();
    head.little(static_cast<std::uint8_t>(payload.size()));
    head.text(std::string_view("\x00\x00\x05\x01", 4));
  }
  head.little(component).little(message);
  if (version == 2) head.text(std::string_view("\x00\x00", 2));
  const std::string body = head.bytes + payload;
  // X.25 checksum, bit by bit
  std::uint16_t crc = 0xFFFF;
  for (const char c : body + static_cast<char>(seed)) {
    crc = static_cast<std::uint16_t>(crc ^ static_cast<std::uint8_t>(c));
    for (int bit = 0; bit < 8; ++bit) {
      crc = static_cast<std::uint16_t>((crc & 1) != 0 ? (crc >> 1) ^ 0x8408 : crc >> 1);
    }
  }
  return ByteWriter{}.text(version == 1 ? "\xfe" : "\xfd").text(body).little(crc).bytes;
}

[[nodiscard]] inline std::string tlog() {
  ByteWriter out;
  for (int i = 0; i < kReadings; ++i) {
    const std::uint64_t t_us = kFirst_us + static_cast<std::uint64_t>(i) * kStep_us;
    const auto t_ms = static_cast<std::uint32_t>(t_us / 1000);
    const auto packet = [&](std::uint8_t message, std::uint8_t seed, const ByteWriter& payload) {
      out.big(std::uint64_t{1'700'000'000'000'000} + t_us);
      out.text(mavlink(i % 2 + 1, message, seed, payload.bytes));
    };
    packet(27, 144,
           ByteWriter{}
               .little(t_us)
               .little(std::int16_t{0})
               .little(std::int16_t{0})
               .little(std::int16_t{-1000})
               .little(std::int16_t{100})
               .little(std::int16_t{200})
               .little(std::int16_t{300})
               .text("", 6));
    packet(30, 39, ByteWriter{}.little(t_ms).text("", 24));
    packet(24, 24,
           ByteWriter{}
               .little(t_us)
               .little(std::int32_t{470'000'000})
               .little(std::int32_t{80'000'000})
               .little(std::int32_t{400'000})
               .text("", 8)
               .little(std::uint8_t{3})
               .little(std::uint8_t{9}));
    packet(33, 104,
           ByteWriter{}
               .little(t_ms)
               .text("", 16)
               .little(std::int16_t{100})
               .little(std::int16_t{200})
               .little(std::int16_t{300})
               .little(std::uint16_t{0}));
    packet(29, 115, ByteWriter{}.little(t_ms).little(966.11f).text("", 6));
    packet(132, 85,
           ByteWriter{}
               .little(t_ms)
               .little(std::uint16_t{10})
               .little(std::uint16_t{4000})
               .little(std::uint16_t{500})
               .text("", 2)
               .little(std::uint8_t{25})
               .little(std::uint8_t{0}));
  }
  return out.bytes;
}

/// Element of GPMF: header, data, padding.
[[nodiscard]] inline std::string gpmf(std::string_view key, char type, std::uint8_t size,
                                      const std::string& data) {
  ByteWriter out;
  out.text(key).little(type).little(size).big(static_cast<std::uint16_t>(data.size() / size));
  out.text(data).text("", (4 - data.size() % 4) % 4);
  return out.bytes;
}

/// GoPro payload of one second: gyroscope and accelerometer at 100 Hz with ORIN `axes` (none if
/// empty), GPS5 with `fix` at 10 Hz.
[[nodiscard]] inline std::string gopro_payload(std::uint32_t fix = 3,
                                               std::string_view model = "HERO9 Black",
                                               std::string_view axes = "ZXY") {
  ByteWriter gyro, accel, gps;
  for (int i = 0; i < 100; ++i) {
    gyro.big(std::int16_t{-30}).big(std::int16_t{-20}).big(std::int16_t{-10});
    accel.big(std::int16_t{981}).big(std::int16_t{0}).big(std::int16_t{0});
  }
  for (int i = 0; i < 10; ++i) {
    gps.big(std::int32_t{470'000'000}).big(std::int32_t{80'000'000}).big(std::int32_t{400'000});
    gps.big(std::int32_t{2236}).big(std::int32_t{374});
  }
  const auto scale = [](std::initializer_list<std::int32_t> values) {
    ByteWriter out;
    for (const std::int32_t value : values) out.big(value);
    return gpmf("SCAL", 'l', 4, out.bytes);
  };
  const auto stream = [](const std::string& elements) { return gpmf("STRM", '\0', 1, elements); };
  const std::string orin = axes.empty() ? "" : gpmf("ORIN", 'c', 1, std::string(axes));
  return gpmf("DEVC", '\0', 1,
              gpmf("DVNM", 'c', 1, std::string(model)) +
                  stream(orin + scale({100}) + gpmf("ACCL", 's', 6, accel.bytes)) +
                  stream(orin + scale({100}) + gpmf("GYRO", 's', 6, gyro.bytes)) +
                  stream(gpmf("GPSF", 'L', 4, ByteWriter{}.big(fix).bytes) +
                         scale({10'000'000, 10'000'000, 1000, 1000, 100}) +
                         gpmf("GPS5", 'l', 20, gps.bytes)));
}

inline constexpr const char* kSubtitles =
    "1\n00:00:00,000 --> 00:00:00,033\n<font size=\"28\">SrtCnt : 1, DiffTime : 33ms\n"
    "2024-01-01 12:00:00,000\n[iso : 100] [focal_len : 240] [dzoom_ratio: 10000] [latitude: 47.0] "
    "[longitude: 8.0] [rel_alt: 5.000 abs_alt: 400.000] [gb_yaw: 3.0 gb_pitch: -90.0 gb_roll: 0.0] "
    "</font>\n\n"
    "2\n00:00:00,033 --> 00:00:00,066\n<font size=\"28\">SrtCnt : 2, DiffTime : 33ms\n"
    "2024-01-01 12:00:00,033\n[iso : 100] [focal_len : 240] [dzoom_ratio: 10000] [latitude: "
    "47.00001] "
    "[longitude: 8.0] [rel_alt: 5.100 abs_alt: 400.100] </font>\n";

}  // namespace stillkite::samples
