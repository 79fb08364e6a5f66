// SPDX-License-Identifier: Apache-2.0
// The walls of the house: which folder may include what, and what every source file must have.
#pragma once

#include <cstddef>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace tagsmith::detail::house {

// The project's folders, lowest first: each may include itself and what stands before it.
std::span<const std::string_view> layers();

// The folders that may stand at the top of the project (hidden and ignored ones apart).
std::span<const std::string_view> top_folders();

// The layer of a source file named relative to the project's root ("decoder/scan/a.cpp" ->
// "decoder/scan", "main.cpp" -> "main.cpp"), empty for files outside the layers (tests, docs).
std::string layer_of(std::string_view file);

// True for a header that is installed for others.
bool is_public(std::string_view file);

// The violations of one source file, `file:line: what was found; what is allowed`. `file` is
// relative to the project's root. Empty = the walls stand.
std::vector<std::string> check_source(std::string_view file, std::string_view text);

// The files, named without extension, that include each other in a ring, in the order of their
// names: a header and its source count as one. `sources` are texts by file.
std::vector<std::string> include_rings(const std::map<std::string, std::string>& sources);

// The names of the types that a header defines at its outermost level.
std::vector<std::string> types_defined(std::string_view header);

// The names of the constants that a source defines at its outermost level.
std::vector<std::string> constants_defined(std::string_view source);

// The number of values that the structs of tuning (`struct FitTuning {`) of a source hold.
std::size_t count_tuned_values(std::string_view source);

// The number of constants that a source names (`constexpr double kLeast = 2`).
std::size_t count_named_constants(std::string_view source);

// The decision records that a text cites: "0016-printing.md" for `decisions/0016-printing.md`. A
// record that is cited by its number alone ("decision 4") is given as it stands there.
std::vector<std::string> cited_decisions(std::string_view text);

// The source files among `sources` (names relative to their folder) that the folder's
// CMakeLists.txt does not name.
std::vector<std::string> unlisted_sources(std::string_view cmake_list,
                                          std::span<const std::string> sources);

}  // namespace tagsmith::detail::house
