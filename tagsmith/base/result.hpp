// SPDX-License-Identifier: Apache-2.0
// Errors as values. A library function that can fail for a reason that the user can correct returns
// Result<T>; it never prints, exits or throws across its module's border.
#pragma once

#include <string>
#include <utility>

#include <tl/expected.hpp>

namespace tagsmith::detail {

// The error in words for the user: where, what was found, what was expected.
struct Error {
  std::string message;
};

template <class T>
using Result = tl::expected<T, Error>;

inline tl::unexpected<Error> fail(std::string message) {
  return tl::unexpected<Error>(Error{std::move(message)});
}

// Hands on the error of a result that has no value.
template <class T>
tl::unexpected<Error> fail(const Result<T>& failed) {
  return tl::unexpected<Error>(failed.error());
}

}  // namespace tagsmith::detail
