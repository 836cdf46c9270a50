#pragma once

#include "flow/frame.hpp"

namespace stillkite {

/// What a reader of images hands out next.
struct ReadResult {
  enum class Status {
    frame,
    undecodable,  ///< there is an image here, but not one that can be looked at
    end,
  };
  Status status = Status::end;
  Frame frame{};  ///< without its index
};

}  // namespace stillkite
