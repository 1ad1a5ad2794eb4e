#include "notes.hpp"

#include <fmt/format.h>

namespace hydrapod::data {

void Notes::add(std::string message, unsigned line, unsigned column, const std::string& kind) {
  if (const auto before = repeated_.find(kind); before != repeated_.end()) {
    Repeated& first = before->second;
    ++first.more;
    all_[first.index].message = fmt::format("{}, and {} more like it", first.message, first.more);
    return;
  }
  if (all_.size() > most) return;
  if (all_.size() == most) message = "and more is wrong with this file than is listed here";
  if (!kind.empty()) repeated_[kind] = {all_.size(), message, 0};
  all_.push_back({.severity = base::Severity::warning,
                  .file = file_,
                  .line = line,
                  .column = line > 0 && column == 0 ? 1 : column,
                  .message = std::move(message)});
}

void Notes::fail(std::string message, unsigned line, unsigned column) const {
  auto found = all_;  // what was noticed before may be why
  found.push_back({.file = file_,
                   .line = line,
                   .column = line > 0 && column == 0 ? 1 : column,
                   .message = std::move(message)});
  throw base::InputError(std::move(found));
}

}  // namespace hydrapod::data
