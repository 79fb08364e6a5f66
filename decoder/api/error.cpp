// SPDX-License-Identifier: Apache-2.0
#include <tagsmith/error.hpp>
#include <tagsmith/version.hpp>

namespace tagsmith {

const char* to_string(ErrorCode code) noexcept {
  switch (code) {
    case ErrorCode::invalid_argument:
      return "invalid_argument";
    case ErrorCode::file_missing:
      return "file_missing";
    case ErrorCode::unreadable_file:
      return "unreadable_file";
    case ErrorCode::invalid_file:
      return "invalid_file";
    case ErrorCode::unwritable_file:
      return "unwritable_file";
    case ErrorCode::failed:
      break;
  }
  return "failed";
}

Error::Error(ErrorCode code, const std::string& message)
    : std::runtime_error(message), code_(code) {}

Error::~Error() = default;

const char* version() noexcept { return TAGSMITH_VERSION; }

}  // namespace tagsmith
