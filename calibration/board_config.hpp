#pragma once

#include <array>
#include <string_view>
#include <utility>

#include "geometry/fields.hpp"

namespace stillkite {

enum class BoardType { checkerboard, charuco, aprilgrid };
template <>
struct EnumNames<BoardType> {
  static constexpr auto value = std::to_array<std::pair<BoardType, std::string_view>>(
      {{BoardType::checkerboard, "checkerboard"},
       {BoardType::charuco, "charuco"},
       {BoardType::aprilgrid, "aprilgrid"}});
};

/// Marker dictionaries of OpenCV, in the order of its enumeration.
enum class MarkerDictionary {
  d4x4_50,
  d4x4_100,
  d4x4_250,
  d4x4_1000,
  d5x5_50,
  d5x5_100,
  d5x5_250,
  d5x5_1000,
  d6x6_50,
  d6x6_100,
  d6x6_250,
  d6x6_1000,
  d7x7_50,
  d7x7_100,
  d7x7_250,
  d7x7_1000,
  original,
  april_16h5,
  april_25h9,
  april_36h10,
  april_36h11
};
template <>
struct EnumNames<MarkerDictionary> {
  static constexpr auto value = std::to_array<std::pair<MarkerDictionary, std::string_view>>(
      {{MarkerDictionary::d4x4_50, "4x4_50"},
       {MarkerDictionary::d4x4_100, "4x4_100"},
       {MarkerDictionary::d4x4_250, "4x4_250"},
       {MarkerDictionary::d4x4_1000, "4x4_1000"},
       {MarkerDictionary::d5x5_50, "5x5_50"},
       {MarkerDictionary::d5x5_100, "5x5_100"},
       {MarkerDictionary::d5x5_250, "5x5_250"},
       {MarkerDictionary::d5x5_1000, "5x5_1000"},
       {MarkerDictionary::d6x6_50, "6x6_50"},
       {MarkerDictionary::d6x6_100, "6x6_100"},
       {MarkerDictionary::d6x6_250, "6x6_250"},
       {MarkerDictionary::d6x6_1000, "6x6_1000"},
       {MarkerDictionary::d7x7_50, "7x7_50"},
       {MarkerDictionary::d7x7_100, "7x7_100"},
       {MarkerDictionary::d7x7_250, "7x7_250"},
       {MarkerDictionary::d7x7_1000, "7x7_1000"},
       {MarkerDictionary::original, "aruco_original"},
       {MarkerDictionary::april_16h5, "apriltag_16h5"},
       {MarkerDictionary::april_25h9, "apriltag_25h9"},
       {MarkerDictionary::april_36h10, "apriltag_36h10"},
       {MarkerDictionary::april_36h11, "apriltag_36h11"}});
};

/// Flat calibration board.
struct BoardConfig {
  BoardType type = BoardType::checkerboard;
  int columns = 9;
  int rows = 7;
  double square_m = 0.03;
  double marker_ratio = 0.75;
  MarkerDictionary dictionary = MarkerDictionary::d5x5_1000;
  double tag_spacing_ratio = 0.3;
  bool allow_unseen_corners = false;

  static void fields(auto& self, auto&& field) {
    field("type", self.type,
          "checkerboard: all of it must be visible; charuco: checkerboard with markers; aprilgrid: "
          "Kalibr's grid of AprilTags 36h11");
    field("columns", self.columns, Range{2, 100},
          "squares along a row, inner corners plus 1; aprilgrid: tags");
    field("rows", self.rows, Range{2, 100},
          "squares along a column, inner corners plus 1; aprilgrid: tags");
    field("square_m", self.square_m, Range{1e-4, 100},
          "side of a square; aprilgrid: side of a tag, with its black border");
    field("marker_ratio", self.marker_ratio, Range{0.1, 0.99},
          "charuco: side of a marker relative to that of a square");
    field("dictionary", self.dictionary, "charuco: dictionary of the markers");
    field("tag_spacing_ratio", self.tag_spacing_ratio, Range{0.05, 2},
          "aprilgrid: gap between two tags relative to their side");
    field(
        "allow_unseen_corners", self.allow_unseen_corners,
        "calibrate although the board was not seen in each corner of the image; the lens model is "
        "extrapolated there");
  }
};

}  // namespace stillkite
