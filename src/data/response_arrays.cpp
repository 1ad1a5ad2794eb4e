/// Frequency responses as arrays of MAT and HDF5 files.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>

#include "array_candidates.hpp"
#include "axis_units.hpp"
#include "channel_roles.hpp"
#include "channel_units.hpp"
#include "hydrapod/base/text.hpp"
#include "response_comments.hpp"
#include "response_files.hpp"
#include "variables_beside.hpp"

namespace hydrapod::data {

namespace {

using Eigen::Index;
using Eigen::MatrixXcd;
using Complex = std::complex<double>;

constexpr std::array<std::string_view, 16> response_words{
    "h",         "frf",      "frfs",       "frf_matrix", "response",   "responses",
    "tf",        "tfs",      "hfr",        "h_frf",      "receptance", "accelerance",
    "inertance", "mobility", "compliance", "transfer"};
constexpr std::array<std::string_view, 3> estimator_words{"h1", "h2", "hv"};
constexpr std::array<std::string_view, 4> output_words{"outputs", "output_names", "output_name",
                                                       "output"};
constexpr std::array<std::string_view, 5> input_words{"inputs", "input_names", "input_name",
                                                      "input", "references"};
constexpr std::array<std::string_view, 3> output_unit_words{"output_units", "output_unit",
                                                            "outputs_units"};
constexpr std::array<std::string_view, 3> input_unit_words{"input_units", "input_unit",
                                                           "inputs_units"};

/// Pairs of endings that name a real and an imaginary part.
std::string sizes_text(const std::vector<std::uint64_t>& sizes) {
  return fmt::format("{}", fmt::join(sizes, " × "));
}

class ArrayReader {
 public:
  ArrayReader(const std::string& path, OpenVariableFile open)
      : notes_(path), opening_(path), file_(open(path, opening_)) {}

  ReadFrequencyResponsesResult read() {
    FrequencyResponses all = holds_own_responses(*file_) ? read_own() : read_foreign();
    return {std::move(all), notes_.all()};
  }

 private:
  [[nodiscard]] const std::vector<Variable>& variables() const { return file_->variables(); }

  [[nodiscard]] std::optional<std::size_t> find(const std::string& name) const {
    const auto at = std::ranges::find(variables(), name, &Variable::name);
    if (at == variables().end()) return {};
    return static_cast<std::size_t>(at - variables().begin());
  }

  [[nodiscard]] std::string text(const std::string& name) const {
    const auto at = find(name);
    return at && variables()[*at].kind == VariableKind::text ? variables()[*at].text : "";
  }

  /// The texts of the first list called one of `words` with `count` of them; one text is a list.
  std::vector<std::string> texts(std::span<const std::string_view> words, std::size_t count) const {
    for (const Variable& v : variables()) {
      if (!is_one_of(words, v.name)) continue;
      if (v.kind == VariableKind::texts && v.texts.size() == count) return v.texts;
      if (v.kind == VariableKind::text && count == 1) return {v.text};
    }
    return {};
  }

  std::vector<Complex> numbers(std::size_t variable) {
    std::vector<Complex> all;
    if (!file_->read_all(variable, all))
      notes_.fail(
          fmt::format("'{}' cannot be read: the file is damaged there, or it is larger than "
                      "fits into memory",
                      base::printable(variables()[variable].name)));
    return all;
  }

  // what response_arrays() wrote

  /// rows × columns at each line; nothing where there is no such array.
  std::vector<MatrixXcd> pages(const char* name, Index rows, Index columns, Index lines) {
    const auto at = find(name);
    if (!at) return {};
    const std::vector<Complex> all = numbers(*at);
    if (static_cast<Index>(all.size()) != rows * columns * lines)
      notes_.fail(fmt::format("'{}' has {} numbers; expected are {} × {} × {}", name, all.size(),
                              rows, columns, lines));
    const bool by_rows = file_->format() == RecordFormat::hdf5;
    std::vector<MatrixXcd> matrices;
    using ByRows = Eigen::Matrix<Complex, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    for (Index k = 0; k < lines; ++k) {
      const Complex* page = all.data() + k * rows * columns;
      matrices.push_back(by_rows ? MatrixXcd(ByRows::Map(page, rows, columns))
                                 : MatrixXcd(MatrixXcd::Map(page, rows, columns)));
    }
    return matrices;
  }

  FrequencyResponses read_own() {
    const auto version = find("format_version");
    if (!version || variables()[*version].number != responses_version)
      notes_.fail(fmt::format("the file is a {} of another version; this program reads version {}",
                              responses_mark, responses_version));
    const auto frequency = find("frequency_hz");
    if (!frequency) notes_.fail("the variable 'frequency_hz' is missing");
    FrequencyResponses all{.title = clean_text(text("title")), .date = clean_text(text("date"))};
    for (const Complex f : numbers(*frequency)) all.frequency.push_back(f.real());
    require_ascending("frequency_hz", all.frequency, 1.0);
    const auto lines = static_cast<Index>(all.lines());
    RecordComments comments;
    unsigned line = 0;
    for (const std::string& comment : base::split(text("description"), "\n"))
      comments.take(comment, ++line);
    const auto described = described_responses(comments, notes_);
    if (described) {
      all.outputs = described->outputs;
      all.inputs = described->inputs;
    } else {
      name_channels(all);
    }
    const auto rows = static_cast<Index>(all.outputs.size()),
               columns = static_cast<Index>(all.inputs.size());
    all.H = pages("response", rows, columns, lines);
    if (all.H.empty()) notes_.fail("the variable 'response' is missing");
    WrittenErrors errors{.noise = pages("noise", rows, rows, lines),
                         .input_factor = pages("input_factor", columns, columns, lines)};
    for (const MatrixXcd& deviation : pages("deviation", rows, columns, lines))
      errors.variance.emplace_back(deviation.real().cwiseAbs2());
    take_errors(std::move(errors), notes_, all);
    take_coherence(all);
    if (described) take_description(*described, notes_, all);
    take_beside_axis(pages("beside_axis", rows, columns, lines), notes_, all);
    return all;
  }

  void take_coherence(FrequencyResponses& all) {
    const auto at = find("coherence");
    if (!at) return;
    const std::vector<Complex> numbers_there = numbers(*at);
    const auto rows = static_cast<Index>(all.outputs.size()),
               lines = static_cast<Index>(all.lines());
    if (static_cast<Index>(numbers_there.size()) != rows * lines) return;
    const bool by_rows = file_->format() == RecordFormat::hdf5;
    for (Index k = 0; k < lines; ++k) {
      Eigen::VectorXd& line = all.multiple_coherence.emplace_back(rows);
      for (Index o = 0; o < rows; ++o)
        line[o] =
            numbers_there[static_cast<std::size_t>(by_rows ? o * lines + k : k * rows + o)].real();
    }
  }

  /// By the lists of texts, where the description is gone.
  void name_channels(FrequencyResponses& all) {
    for (const auto& [list, unit_list, role, channels] :
         {std::tuple{"outputs", "output_units", Role::response, &all.outputs},
          std::tuple{"inputs", "input_units", Role::excitation, &all.inputs}}) {
      const auto at = find(list);
      if (!at || variables()[*at].kind == VariableKind::numbers)
        notes_.fail(fmt::format("the variable '{}' is missing", list));
      const Variable& v = variables()[*at];
      const auto names = v.kind == VariableKind::text ? std::vector{v.text} : v.texts;
      const std::array<std::string_view, 1> word{unit_list};
      const auto units = texts(word, names.size());
      for (std::size_t c = 0; c < names.size(); ++c)
        channels->push_back(
            {.name = names[c], .unit = units.empty() ? "" : units[c], .role = role});
      make_names_unique(*channels);
    }
  }

  // files of other programs

  FrequencyResponses read_foreign() {
    auto arrays = candidates(*file_);
    const auto lists = frequency_lists(*file_, arrays);
    if (lists.empty())
      notes_.fail(
          "the file holds no frequency responses: expected are complex arrays (such as H or frf) "
          "and "
          "a list of frequencies as long as one of their indices (such as f or freq)");
    if (lists.size() > 1)
      notes_.fail(fmt::format("there are several lists of frequencies: '{}' and '{}'; keep one",
                              base::printable(variables()[lists[0]].name),
                              base::printable(variables()[lists[1]].name)));
    FrequencyResponses all;
    take_frequencies(lists[0], all);
    std::erase_if(arrays, [&](const Candidate& c) { return !has_size(c, all.lines()); });
    const auto is_response_list = [&](const Candidate& c) {
      return values_beside(c, all.lines()).empty();
    };
    const auto is_named = [](const Candidate& c) { return is_one_of(response_words, c.name); };
    if (std::ranges::count_if(arrays, is_named) == 1 && arrays.size() > 1) {
      for (const Candidate& c : arrays)
        if (!is_named(c)) left_out(c);
      std::erase_if(arrays, [&](const Candidate& c) { return !is_named(c); });
    }
    if (arrays.size() == 1)
      take_array(arrays[0], all);
    else if (std::ranges::all_of(arrays, is_response_list))
      take_lists(arrays, all);
    else
      refuse_several(arrays);
    require_imaginary_parts(all, notes_);
    return all;
  }

  void left_out(const Candidate& c) {
    notes_.add(fmt::format("'{}' ({}) is left out", base::printable(c.name), sizes_text(c.sizes)));
  }

  [[noreturn]] void refuse_several(const std::vector<Candidate>& arrays) {
    std::string names;
    for (const Candidate& c : arrays)
      names += fmt::format("{}'{}' ({})", names.empty() ? "" : ", ", base::printable(c.name),
                           sizes_text(c.sizes));
    notes_.fail("several arrays may be the responses: " + names +
                "; keep one in the file, or call it H or frf");
  }

  void take_frequencies(std::size_t variable, FrequencyResponses& all) {
    const Variable& v = variables()[variable];
    const auto hertz = hertz_of(v.unit, is_circular_frequency(v.name));
    if (!hertz)
      notes_.fail(fmt::format("the unit \"{}\" of the frequencies '{}' {}", base::printable(v.unit),
                              base::printable(v.name), frequency_problem(v.unit)));
    for (const Complex f : numbers(variable)) all.frequency.push_back(*hertz * f.real());
    require_ascending(v.name, all.frequency, *hertz);
  }

  /// `factor`: [Hz] of the file's unit.
  void require_ascending(const std::string& name, const std::vector<double>& frequency,
                         double factor) {
    for (std::size_t k = 0; k < frequency.size(); ++k)
      if (!std::isfinite(frequency[k]) || frequency[k] < 0.0 ||
          (k > 0 && frequency[k] <= frequency[k - 1]))
        notes_.fail(
            fmt::format("the frequencies '{}' do not ascend from 0 Hz on: number {} is {}{}",
                        base::printable(name), k + 1, frequency[k] / factor,
                        frequency[k] < 0.0 ? two_sided_remedy : ""));
  }

  /// Sizes of the indices besides that of the frequencies, without those of 1.
  static std::vector<std::uint64_t> values_beside(const Candidate& c, std::uint64_t lines) {
    auto sizes = c.sizes;
    if (const auto at = std::ranges::find(sizes, lines); at != sizes.end()) sizes.erase(at);
    std::erase(sizes, 1U);
    return sizes;
  }

  /// Numbers by the user's indices, of which the first runs fastest here.
  std::vector<Complex> values_of(const Candidate& c) {
    std::vector<Complex> values = numbers(c.variable);
    if (c.imaginary) {
      const std::vector<Complex> imaginary = numbers(*c.imaginary);
      for (std::size_t k = 0; k < values.size(); ++k)
        values[k] = {values[k].real(), imaginary[k].real()};
    }
    return values;
  }

  /// Steps of the user's indices through the numbers of the file.
  [[nodiscard]] std::vector<std::uint64_t> steps_of(const Candidate& c) const {
    std::vector<std::uint64_t> steps(c.sizes.size());
    const bool last_is_fast = file_->format() == RecordFormat::hdf5;
    std::uint64_t step = 1;
    for (std::size_t k = 0; k < steps.size(); ++k) {
      const std::size_t index = last_is_fast ? steps.size() - 1 - k : k;
      steps[index] = step;
      step *= c.sizes[index];
    }
    return steps;
  }

  struct Axes {
    std::size_t line{};
    std::optional<std::size_t> output{}, input{};  ///< none: there is one
  };

  /// Which index counts what.
  Axes axes_of(const Candidate& c, std::size_t lines) {
    Axes axes;
    const auto same = std::ranges::count(c.sizes, static_cast<std::uint64_t>(lines));
    if (same > 1)
      notes_.fail(
          fmt::format("'{}' is {} and there are {} frequencies: which index counts them "
                      "cannot be told; leave a frequency out",
                      base::printable(c.name), sizes_text(c.sizes), lines));
    axes.line = static_cast<std::size_t>(std::ranges::find(c.sizes, lines) - c.sizes.begin());
    std::vector<std::size_t> others;
    for (std::size_t k = 0; k < c.sizes.size(); ++k)
      if (k != axes.line) others.push_back(k);
    if (others.size() > 2) std::erase_if(others, [&](std::size_t k) { return c.sizes[k] == 1; });
    if (others.size() > 2)
      notes_.fail(fmt::format("'{}' is {}: expected are indices of outputs, inputs and frequencies",
                              base::printable(c.name), sizes_text(c.sizes)));
    const auto named = [&](std::size_t k, std::span<const std::string_view> words) {
      return !texts(words, c.sizes[k]).empty();
    };
    if (others.size() == 2) {
      const bool swapped = c.sizes[others[0]] != c.sizes[others[1]] &&
                           named(others[0], input_words) && named(others[1], output_words);
      axes.output = others[swapped ? 1 : 0];
      axes.input = others[swapped ? 0 : 1];
    } else if (others.size() == 1) {
      const bool inputs = named(others[0], input_words) && !named(others[0], output_words);
      (inputs ? axes.input : axes.output) = others[0];
    }
    return axes;
  }

  std::vector<Channel> channels_of(std::size_t count, Role role) {
    const bool outputs = role == Role::response;
    const auto names = outputs ? texts(output_words, count) : texts(input_words, count);
    const auto units = outputs ? texts(output_unit_words, count) : texts(input_unit_words, count);
    std::vector<Channel> channels;
    for (std::size_t c = 0; c < count; ++c) {
      Channel& channel = channels.emplace_back();
      channel.role = role;
      channel.unit = units.empty() ? "" : units[c];
      channel.name = !names.empty() ? names[c]
                     : outputs      ? fmt::format("output {}", c + 1)
                     : count == 1   ? "input"
                                    : fmt::format("input {}", c + 1);
      channel.point = names.empty() && count > 1 ? static_cast<int>(c + 1) : 0;
    }
    if (units.empty())
      notes_.add(fmt::format("the file states no units of the {} ({}_units)",
                             outputs ? "outputs" : "inputs", outputs ? "output" : "input"));
    make_names_unique(channels);
    return channels;
  }

  /// Units become SI.
  void settle_units(FrequencyResponses& all) {
    const std::vector<double> up = to_si(all.outputs, notes_, false),
                              down = to_si(all.inputs, notes_, false);
    tell_measured_inputs(all.inputs);
    for (MatrixXcd& H : all.H)
      for (Index o = 0; o < H.rows(); ++o)
        for (Index i = 0; i < H.cols(); ++i)
          H(o, i) *= up[static_cast<std::size_t>(o)] / down[static_cast<std::size_t>(i)];
  }

  void take_array(const Candidate& c, FrequencyResponses& all) {
    const Axes axes = axes_of(c, all.lines());
    const auto size = [&](const std::optional<std::size_t>& axis) {
      return axis ? static_cast<std::size_t>(c.sizes[*axis]) : std::size_t{1};
    };
    const std::size_t outputs = size(axes.output), inputs = size(axes.input);
    notes_.add(fmt::format("'{}' ({}): {} output{}, {} input{}, {} frequencies",
                           base::printable(c.name), sizes_text(c.sizes), outputs,
                           outputs == 1 ? "" : "s", inputs, inputs == 1 ? "" : "s", all.lines()));
    all.outputs = channels_of(outputs, Role::response);
    all.inputs = channels_of(inputs, Role::excitation);
    const auto values = values_of(c);
    const auto steps = steps_of(c);
    for (std::size_t k = 0; k < all.lines(); ++k) {
      MatrixXcd& H = all.H.emplace_back(static_cast<Index>(outputs), static_cast<Index>(inputs));
      for (std::size_t o = 0; o < outputs; ++o)
        for (std::size_t i = 0; i < inputs; ++i)
          H(static_cast<Index>(o), static_cast<Index>(i)) =
              values[k * steps[axes.line] + (axes.output ? o * steps[*axes.output] : 0) +
                     (axes.input ? i * steps[*axes.input] : 0)];
    }
    settle_units(all);
  }

  /// Each list is one output.
  void take_lists(const std::vector<Candidate>& lists, FrequencyResponses& all) {
    if (std::ranges::all_of(lists,
                            [](const Candidate& c) { return is_one_of(estimator_words, c.name); }))
      refuse_several(lists);
    std::string names;
    const auto count = static_cast<Index>(lists.size());
    all.outputs = channels_of(lists.size(), Role::response);
    all.inputs = channels_of(1, Role::excitation);
    all.H.assign(all.lines(), MatrixXcd(count, 1));
    for (std::size_t o = 0; o < lists.size(); ++o) {
      const auto values = values_of(lists[o]);
      for (std::size_t k = 0; k < all.lines(); ++k) all.H[k](static_cast<Index>(o), 0) = values[k];
      if (const std::string& unit = variables()[lists[o].variable].unit; !unit.empty())
        notes_.add(fmt::format("the unit \"{}\" of '{}' is left aside", base::printable(unit),
                               base::printable(lists[o].name)),
                   0, 0, "unit of a list");
      all.outputs[o].name = lists[o].name;
      all.outputs[o].point = 0;
      names += (names.empty() ? "" : ", ") + base::printable(lists[o].name);
    }
    make_names_unique(all.outputs);
    notes_.add("each list is taken as the response of one output to one input: " + names);
    settle_units(all);
  }

  Notes notes_, opening_;
  std::unique_ptr<VariableFile> file_;
};

}  // namespace

ReadFrequencyResponsesResult read_response_arrays(const std::string& path, OpenVariableFile open) {
  return ArrayReader(path, open).read();
}

}  // namespace hydrapod::data
