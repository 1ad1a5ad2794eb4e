#pragma once
/// Refuses TOML text that nests without reason. Private to the reader.
///
/// toml++ limits nested arrays and inline tables, but builds one table per part of a dotted key and
/// tears them down recursively: "a.a.a. …" a hundred thousand times overflows the stack.

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace hydrapod::model {

struct NestingFault {
  std::size_t offset{};  ///< byte of the text
  std::string message{};
};

/// The first place where brackets are nested, or a dotted key is composed, more than 32 deep.
std::optional<NestingFault> check_nesting(std::string_view text);

}  // namespace hydrapod::model
