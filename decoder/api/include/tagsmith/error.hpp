// SPDX-License-Identifier: Apache-2.0
// The one exception of the library.
#pragma once

#include <stdexcept>
#include <string>

#include <tagsmith/export.hpp>

namespace tagsmith {

// The kind of error, for programs; the message is for people.
enum class ErrorCode {
  invalid_argument,  // a value that the function does not accept
  file_missing,      // there is no such file
  unreadable_file,   // a file that cannot be read at all: no rights, a folder, no picture
  invalid_file,      // a survey, rig or template with errors; the message lists them all
  unwritable_file,   // a file that cannot be written
  failed,            // the request cannot be fulfilled with these files and values
};

// "invalid_argument" and so on.
TAGSMITH_EXPORT const char* to_string(ErrorCode code) noexcept;

// Thrown by every function that can fail for a reason that its caller can correct. The message says
// where, what was found and what was expected. Any other exception comes from the standard library,
// such as std::bad_alloc.
class TAGSMITH_EXPORT Error : public std::runtime_error {
 public:
  Error(ErrorCode code, const std::string& message);
  Error(const Error&) = default;
  Error& operator=(const Error&) = default;
  ~Error() override;

  ErrorCode code() const noexcept { return code_; }

 private:
  ErrorCode code_;
};

}  // namespace tagsmith
