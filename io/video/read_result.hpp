#pragma once

#include "flow/frame.hpp"

namespace stillkite {

/// What a reader of pictures hands out next.
struct ReadResult {
  enum class Status {
    frame,
    undecodable,  ///< there is a picture here, but not one that can be looked at
    end,
  };
  Status status = Status::end;
  Frame frame{};  ///< without its index
};

}  // namespace stillkite
