#include "hydrapod/model/section.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "hydrapod/base/text.hpp"
#include "hydrapod/base/units.hpp"

namespace hydrapod::model {

namespace {

const Vector3 unread_vector{unread, unread, unread};

/// "a mass, as a number in kg or a string such as "0.5 kg"".
std::string expected_number(std::string_view unit) {
  if (unit == "1") return "a pure number such as 0.02";
  return fmt::format("{}, as a number in {} or a string such as \"0.5 {}\"{}",
                     base::dimension_name(unit), unit, unit,
                     is_spring_rate(unit) ? ", or \"rigid\"" : "");
}

std::string array_of(std::size_t size, std::string_view unit) {
  const std::string in = unit == "1" ? "" : fmt::format(" in {}", unit);
  return fmt::format("an array of {} numbers{}", size, in);
}

}  // namespace

Section::Section(const Node& root, Faults& faults)
    : specific_{&root, "", root.place}, faults_(&faults) {}

Section::Section(Table specific, Table general, bool silent, Faults& faults)
    : specific_(std::move(specific)),
      general_(std::move(general)),
      silent_(silent),
      faults_(&faults) {}

Section Section::overlaid(const Section& specific, const Section& general) {
  return {specific.specific_, general.specific_, specific.silent_ || general.silent_,
          *specific.faults_};
}

Section Section::at(const Node& table, std::string path, Faults& faults) {
  return {{&table, std::move(path), table.place}, {}, false, faults};
}

Section::Table Section::below(const Table& table, std::string_view key) {
  if (table.node == nullptr && table.path.empty()) return {};  // there is no general table
  const Node* node = table.node != nullptr ? table.node->find(key) : nullptr;
  if (node != nullptr && !node->is_table()) node = nullptr;  // check_keys has reported it
  return {node, joined_path(table.path, key), node != nullptr ? node->place : table.place};
}

Section::Value Section::find(std::string_view key) const {
  for (const Table* table : {&specific_, &general_}) {
    const Node* node = table->node != nullptr ? table->node->find(key) : nullptr;
    if (node != nullptr) return {node, joined_path(table->path, key)};
  }
  return {};
}

Section Section::optional_table(std::string_view key) const {
  Section section(below(specific_, key), below(general_, key), silent_, *faults_);
  if (!section.exists() && (has(key) || is_misspelt(key))) section.silent_ = true;
  if (section.silent_) faults_->mark_incomplete();
  return section;
}

Section Section::required_table(std::string_view key, std::string_view advice) const {
  Section section = optional_table(key);
  if (!section.exists()) {
    if (!section.silent_) {
      report_missing(key, fmt::format("required table [{}]", missing_path(key)), advice);
    }
    section.silent_ = true;
    faults_->mark_incomplete();
  }
  return section;
}

std::string_view Section::choice(std::string_view first, std::string_view second) const {
  for (const Table* table : {&specific_, &general_}) {
    if (table->node == nullptr) continue;
    const bool has_first = table->node->find(first) != nullptr;
    const bool has_second = table->node->find(second) != nullptr;
    if (has_first && has_second) {
      faults_->add(
          table->node->place, table->path,
          fmt::format("both `{}` and `{}` are given, expected one of them", first, second));
      faults_->mark_incomplete();
    }
    if (has_first) return first;
    if (has_second) return second;
  }
  return {};
}

bool Section::is_misspelt(std::string_view key) const {
  if (faults_->misspelt(joined_path(specific_.path, key))) return true;
  return !general_.path.empty() && faults_->misspelt(joined_path(general_.path, key));
}

const Section::Table& Section::lacking() const {
  return general_.node != nullptr ? general_ : specific_;
}

std::string Section::missing_path(std::string_view key) const {
  return joined_path(lacking().path, key);
}

void Section::report_missing(std::string_view key, std::string_view what,
                             std::string_view advice) const {
  faults_->mark_incomplete();
  if (silent_ || is_misspelt(key)) return;
  faults_->add(lacking().place, missing_path(key), fmt::format("{} is missing{}", what, advice));
}

void Section::report_missing_numbers(std::string_view key, std::string_view unit,
                                     std::size_t size) const {
  if (size == 1 && unit == "1") return report_missing(key, "required number");
  report_missing(key, fmt::format("required value ({})",
                                  size == 1 ? expected_number(unit) : array_of(size, unit)));
}

void Section::report(const Value& value, std::string message) const {
  faults_->add(value.node->place, value.path, std::move(message));
  faults_->mark_incomplete();
}

double Section::read_number(const Value& value, std::string_view unit) const {
  const Node& node = *value.node;
  if (node.is_number()) {
    if (std::isfinite(node.number)) return node.number;
    report(value, fmt::format("is {}, expected a finite number", node.number));
  } else if (node.kind == Node::Kind::text) {
    if (node.text == rigid_word && is_spring_rate(unit)) return rigid_stiffness;
    const auto quantity = base::read_quantity(node.text, unit);
    if (quantity.ok()) return quantity.value;
    const bool rigid = is_spring_rate(unit) && base::lower_case(node.text) == rigid_word;
    report(value, quantity.problem + (rigid ? "; did you mean \"rigid\"?" : ""));
  } else {
    report(value, fmt::format("is {}, expected {}", described(node), expected_number(unit)));
  }
  return unread;
}

double Section::number(std::string_view key, std::string_view unit) const {
  const auto value = optional_number(key, unit);
  if (value) return *value;
  report_missing_numbers(key, unit, 1);
  return unread;
}

double Section::number(std::string_view key, std::string_view unit, double fallback) const {
  return optional_number(key, unit).value_or(fallback);
}

std::optional<double> Section::optional_number(std::string_view key, std::string_view unit) const {
  const Value value = find(key);
  if (!value) return std::nullopt;
  return read_number(value, unit);
}

std::vector<Section::Value> Section::elements(const Value& value, std::size_t size,
                                              std::string_view what) const {
  std::vector<Value> found;
  if (value.node->kind != Node::Kind::array || value.node->children.size() != size) {
    report(value, fmt::format("is {}, expected {}", described(*value.node), what));
    return found;
  }
  for (std::size_t i = 0; i < size; ++i) found.push_back(element(value, i));
  return found;
}

Section::Value Section::element(const Value& array, std::size_t i) {
  const auto& children = array.node->children;
  return {i < children.size() ? &children[i] : nullptr, fmt::format("{}[{}]", array.path, i)};
}

std::vector<double> Section::read_array(const Value& value, std::size_t size,
                                        std::string_view unit) const {
  std::vector<double> numbers(size, unread);
  const auto found = elements(value, size, array_of(size, unit));
  for (std::size_t i = 0; i < found.size(); ++i) numbers[i] = read_number(found[i], unit);
  return numbers;
}

Vector3 Section::read_vector(const Value& value, std::string_view unit) const {
  const auto numbers = read_array(value, 3, unit);
  return {numbers[0], numbers[1], numbers[2]};
}

Vector3 Section::vector(std::string_view key, std::string_view unit) const {
  const Value value = find(key);
  if (value) return read_vector(value, unit);
  report_missing_numbers(key, unit, 3);
  return unread_vector;
}

Vector3 Section::vector(std::string_view key, std::string_view unit,
                        const Vector3& fallback) const {
  const Value value = find(key);
  return value ? read_vector(value, unit) : fallback;
}

std::string Section::optional_text(std::string_view key) const {
  const Value value = find(key);
  if (!value) return "";
  if (value.node->kind != Node::Kind::text) {
    report(value, fmt::format("is {}, expected a string", described(*value.node)));
    return "";
  }
  return value.node->text;
}

std::string Section::text(std::string_view key) const {
  const Value value = find(key);
  if (!value) report_missing(key, "required value (a string)");
  std::string found = optional_text(key);
  if (value && value.node->kind == Node::Kind::text && found.empty()) {
    report(value, "is an empty string, expected some text");
  }
  return found;
}

std::size_t Section::word(std::string_view key, std::span<const std::string_view> words) const {
  const Value value = find(key);
  if (!value) return 0;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (value.node->kind == Node::Kind::text && value.node->text == words[i]) return i;
  }
  std::string accepted;
  for (const auto word : words) {
    accepted += fmt::format("{}\"{}\"", accepted.empty() ? "" : " or ", word);
  }
  report(value, fmt::format("is {}, expected {}", described(*value.node), accepted));
  return 0;
}

}  // namespace hydrapod::model
