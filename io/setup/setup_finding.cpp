#include "io/setup/setup_finding.hpp"

#include <algorithm>

namespace stillkite {

SetupVerdict worst_verdict(const SetupFindings& findings) {
  for (const SetupVerdict verdict : {SetupVerdict::wrong, SetupVerdict::doubtful}) {
    if (std::ranges::any_of(findings, [&](const auto& f) { return f.verdict == verdict; })) {
      return verdict;
    }
  }
  return SetupVerdict::ok;
}

}  // namespace stillkite
