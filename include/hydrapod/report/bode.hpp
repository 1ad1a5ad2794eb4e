#pragma once
/// Bode diagrams, rigid beside flexible: JSON, CSV and pictures.

#include <optional>
#include <string>
#include <vector>

#include "hydrapod/report/json.hpp"
#include "hydrapod/response/peaks.hpp"

namespace hydrapod::report {

struct BodeOptions {
  response::Input input{response::Input::wrench};
  response::Output output{response::Output::displacement};
  std::optional<spatial::Vector3>
      p_PQ{};                    ///< the point, in P [m]; default: the platform's mass centre
  std::optional<double> from{};  ///< [rad/s]; default: a third of the lowest frequency that is felt
  std::optional<double> to{};    ///< [rad/s]; default: twice the highest one
  int points{2000};
};

struct Bode {
  BodeOptions options{};  ///< with every default filled in
  modal::ModeTable table{};
  std::vector<double> omega{};  ///< [rad/s], evenly spaced on a logarithmic axis
  std::vector<response::Matrix6c> real{}, rigid{};
  std::vector<response::Peak> real_peaks{}, rigid_peaks{};
};

/// "m/N", "rad/s/(N m)"; what an entry of the response is measured in.
std::string response_unit(response::Output output, int out_direction, int in_direction);

Json bode_json(const Bode& bode);
/// Reads it. Of `table` there is the model, and the labels of the modes at peaks.
Bode bode_from_json(const Json& json, const std::string& file);

/// A 6×6 response over frequency: `omega_rad_s[]`, `frequency_hz[]`, `response[output][input]` with
/// `re[]` and `im[]`; and back.
Json response_json(const std::vector<double>& omega, const std::vector<response::Matrix6c>& H);
std::vector<double> response_from_json(const Json& json, const std::string& file,
                                       std::vector<response::Matrix6c>& H);

Json peaks_json(const std::vector<response::Peak>& peaks, const modal::AnalysedModel& model);

/// Frequency in Hz and rad/s, then re and im of all 36 entries of both models, a header line with
/// units.
std::string bode_csv(const Bode& bode);

/// One entry of the 6×6 response.
struct Entry {
  int output{};
  int input{};
};

/// What a plot says about itself.
struct PlotText {
  std::string title{};
  std::string subtitle{};  ///< pose, point, damping, gravity: what a reader must know
};

/// Magnitude and phase of `entries` as a gnuplot script that plots to `terminal` and `file`.
std::string bode_script(const Bode& bode, const std::vector<Entry>& entries, const PlotText& text,
                        const std::string& terminal, const std::string& file);

/// Runs gnuplot; the picture's format follows from the ending of `path` (.svg, .png, .pdf). The
/// file is written whole or not at all. Throws base::InputError for another ending or a folder that
/// is not there, base::ComputationError when gnuplot is missing or fails.
void plot_bode(const Bode& bode, const std::vector<Entry>& entries, const PlotText& text,
               const std::string& path);

}  // namespace hydrapod::report
