/// One state space as MAT, HDF5, NPZ and JSON.

#include "hydrapod/data/record_io.hpp"
#include "hydrapod/exchange/exchange.hpp"
#include "npz.hpp"

namespace hydrapod::exchange {

namespace {

constexpr const char* mark = "hydrapod state space";

/// The columns of a table of signals.
struct Columns {
  std::vector<std::string> names{}, units{};
  std::vector<double> rest{};
};

Columns columns(const std::vector<Signal>& signals) {
  Columns result;
  for (const auto& signal : signals) {
    result.names.push_back(signal.name);
    result.units.push_back(signal.unit);
    result.rest.push_back(signal.rest);
  }
  return result;
}

/// Tells `sink` every member: matrix, number, text, texts, list.
template <class Sink>
void put(const StateSpace& system, const FileHead& head, Sink& sink) {
  sink.text("format", mark);
  sink.number("format_version", 1.0);
  sink.text("title", head.title);
  sink.text("date", head.date);
  sink.matrix("A", system.A);
  sink.matrix("B", system.B);
  sink.matrix("C", system.C);
  sink.matrix("D", system.D);
  sink.number("sample_time", system.sample_time);
  sink.number("delay", system.delay);
  sink.number("pade_order", system.pade_order);
  const auto signals = [&](const std::string& prefix, const std::vector<Signal>& all) {
    const auto c = columns(all);
    sink.texts(prefix + "_names", c.names);
    sink.texts(prefix + "_units", c.units);
    sink.list(prefix + "_rest", c.rest);
  };
  signals("state", system.states);
  signals("input", system.inputs);
  signals("output", system.outputs);
  if (!system.reduction) return;
  sink.number("reduction_bound", system.reduction->bound);
  sink.list("reduction_hankel", system.reduction->hankel);
  sink.list("reduction_output_scales", system.reduction->output_scales);
  sink.list("reduction_input_scales", system.reduction->input_scales);
}

struct Variables {
  std::vector<data::MatVariable> all{};
  void matrix(const char* name, const Eigen::MatrixXd& m) {
    all.push_back(data::mat_array(name, m));
  }
  void number(const char* name, double value) { all.push_back(data::mat_number(name, value)); }
  void text(const char* name, const std::string& text) {
    all.push_back(data::mat_text(name, text));
  }
  void texts(const std::string& name, const std::vector<std::string>& texts) {
    all.push_back(data::mat_list(name, texts));
  }
  void list(const std::string& name, const std::vector<double>& numbers) {
    all.push_back(data::mat_array(
        name, Eigen::VectorXd::Map(numbers.data(), static_cast<Eigen::Index>(numbers.size()))));
  }
};

struct Archive {
  NpzWriter npz{};
  void matrix(const char* name, const Eigen::MatrixXd& m) { npz.add(name, m); }
  void number(const char* name, double value) { npz.add_number(name, value); }
  void text(const char* name, const std::string& text) { npz.add_text(name, text); }
  void texts(const std::string& name, const std::vector<std::string>& texts) {
    npz.add_texts(name, texts);
  }
  void list(const std::string& name, const std::vector<double>& numbers) {
    npz.add_list(name, numbers);
  }
};

std::vector<data::MatVariable> variables(const StateSpace& system, const FileHead& head) {
  Variables sink;
  put(system, head, sink);
  return sink.all;
}

nlohmann::ordered_json matrix_json(const Eigen::MatrixXd& matrix) {
  auto rows = nlohmann::ordered_json::array();
  for (Eigen::Index i = 0; i < matrix.rows(); ++i) {
    auto row = nlohmann::ordered_json::array();
    for (Eigen::Index j = 0; j < matrix.cols(); ++j) row.push_back(matrix(i, j));
    rows.push_back(std::move(row));
  }
  return rows;
}

nlohmann::ordered_json signals_json(const std::vector<Signal>& signals) {
  auto all = nlohmann::ordered_json::array();
  for (const auto& s : signals)
    all.push_back({{"name", s.name}, {"unit", s.unit}, {"rest", s.rest}});
  return all;
}

}  // namespace

nlohmann::ordered_json state_space_json(const StateSpace& system) {
  nlohmann::ordered_json json{{"sample_time_s", system.sample_time},
                              {"delay_s", system.delay},
                              {"pade_order", system.pade_order},
                              {"states", signals_json(system.states)},
                              {"inputs", signals_json(system.inputs)},
                              {"outputs", signals_json(system.outputs)},
                              {"A", matrix_json(system.A)},
                              {"B", matrix_json(system.B)},
                              {"C", matrix_json(system.C)},
                              {"D", matrix_json(system.D)}};
  if (const auto& of = system.reduction)
    json["reduction"] = {{"states_before", of->from},
                         {"bound", of->bound},
                         {"hankel_singular_values", of->hankel},
                         {"output_scales", of->output_scales},
                         {"input_scales", of->input_scales}};
  return json;
}

void write_state_space_mat(const std::string& path, const StateSpace& system,
                           const FileHead& head) {
  data::write_mat_variables(path, variables(system, head));
}

void write_state_space_hdf5(const std::string& path, const StateSpace& system,
                            const FileHead& head) {
  data::write_hdf5_variables(path, variables(system, head));
}

std::string state_space_npz(const StateSpace& system, const FileHead& head) {
  Archive sink;
  put(system, head, sink);
  return sink.npz.bytes();
}

}  // namespace hydrapod::exchange
