#include "hydrapod/report/measured_results.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "gnuplot.hpp"
#include "prefix.hpp"

namespace hydrapod::report {

namespace {

constexpr std::size_t most_stretches = 800;  // a row is 590 pixels wide
constexpr int name_band = 18;                // above a row [px]
constexpr int row_height = 146, picture_width = 1200, top_band = 62, bottom_band = 50;  // [px]

double lower(double a, double b) { return std::isnan(a) || b < a ? b : a; }
double higher(double a, double b) { return std::isnan(a) || b > a ? b : a; }

/// Of the samples of a channel that are drawn.
double largest_of(const TraceBuilder& traces, std::size_t channel) {
  double largest = 0.0;
  for (const auto& stretch : traces.stretches())
    for (const double value : {stretch.low[channel], stretch.high[channel]})
      if (std::isfinite(value)) largest = std::max(largest, std::abs(value));
  return largest;
}

/// Columns: time, then low and high of every channel shown.
std::string trace_block(const data::RecordHeader& header, const TraceBuilder& traces,
                        const std::vector<std::size_t>& shown,
                        const std::vector<ShownUnit>& units) {
  std::string text;
  const double step = static_cast<double>(traces.samples_per_stretch()) / header.sample_rate;
  for (std::size_t i = 0; i < traces.stretches().size(); ++i) {
    text += fmt::format("{:.9g}", header.start + step * static_cast<double>(i));
    for (std::size_t k = 0; k < shown.size(); ++k)
      text += fmt::format(" {:.6g} {:.6g}", traces.stretches()[i].low[shown[k]] / units[k].size,
                          traces.stretches()[i].high[shown[k]] / units[k].size);
    text += '\n';
  }
  return block_of("traces", text);
}

/// Columns: Hz, then dB of the density of every channel shown, of lines that share a pixel of the
/// logarithmic axis the highest.
std::string spectrum_block(const data::Spectrum& spectrum, const std::vector<std::size_t>& shown) {
  constexpr int most_lines = 400;  // a spectrum is 350 pixels wide
  const std::vector<double> frequency(spectrum.frequency.begin() + 1, spectrum.frequency.end());
  const auto begins = stretches_of(frequency, true, most_lines);
  std::string text;
  for (std::size_t s = 0; s + 1 < begins.size(); ++s) {
    text += fmt::format("{:.6g}", frequency[begins[s]]);
    const auto first = static_cast<Eigen::Index>(begins[s]);
    const auto count = static_cast<Eigen::Index>(begins[s + 1] - begins[s]);
    for (const std::size_t c : shown) {
      const double density =
          spectrum.density.col(static_cast<Eigen::Index>(c)).segment(first + 1, count).maxCoeff();
      text += density > 0.0 ? fmt::format(" {:.3f}", 10.0 * std::log10(density)) : " NaN";
    }
    text += '\n';
  }
  return block_of("spectra", text);
}

std::string row_script(const data::Channel& channel, const ShownUnit& shown_as, double top,
                       double bottom, std::size_t row, bool last, bool whole,
                       const data::Spectrum& spectrum) {
  const std::string unit = channel.unit.empty() ? "?" : channel.unit;
  std::string text = at_screen({0.11, 0.60, top, bottom}) +
                     fmt::format("set label 2 {} at graph 0,1 offset 0,0.6 left font ',9'\n",
                                 quoted(channel.name));
  text += fmt::format(
      "unset logscale\nset xrange [*:*]\nset xtics autofreq\nset format x '{}'\nset xlabel "
      "'{}'\nset ylabel {}\n",
      last ? "%g" : "", last ? "s" : "", quoted(shown_as.name));
  const std::size_t low = 2 + 2 * row, high = low + 1;
  text += whole ? fmt::format("plot $traces using 1:{} with lines lw 1 lc rgb '#0072b2'\n", low)
                : fmt::format("plot $traces using 1:{}:{} with filledcurves lc rgb '#0072b2'\n",
                              low, high);
  text += "unset label 2\n";
  if (spectrum.segments == 0 || spectrum.frequency.size() < 3) return text;
  const auto& f = spectrum.frequency;
  text += at_screen({0.69, 0.985, top, bottom}) + logarithmic_axis(f[1], f[f.size() - 1]);
  text += fmt::format("set format x '{}'\nset xlabel '{}'\nset ylabel {}\n", last ? "%g" : "",
                      last ? "Hz" : "", quoted("dB re 1 (" + unit + ")²/Hz"));
  return text + fmt::format("plot $spectra using 1:{} with lines lw 1 lc rgb '#d55e00'\n", 2 + row);
}

/// What of the record a picture shows, where it is not all.
std::string shown_channels(const data::RecordHeader& header,
                           const std::vector<std::size_t>& shown) {
  return shown.size() == header.channels.size()
             ? ""
             : fmt::format("; shown: {} of {} channels", shown.size(), header.channels.size());
}

}  // namespace

TraceBuilder::TraceBuilder(std::size_t channels) : channels_(channels) {}

void TraceBuilder::add(const Eigen::Ref<const data::Samples>& samples) {
  constexpr double missing = std::numeric_limits<double>::quiet_NaN();
  for (Eigen::Index row = 0; row < samples.rows(); ++row) {
    if (stretches_.empty() || in_last_ == length_) {
      if (stretches_.size() == most_stretches) halve();
      stretches_.push_back(
          {std::vector<double>(channels_, missing), std::vector<double>(channels_, missing)});
      in_last_ = 0;
    }
    ++in_last_;
    for (std::size_t c = 0; c < channels_; ++c) {
      const double value = samples(row, static_cast<Eigen::Index>(c));
      if (!std::isfinite(value)) continue;
      stretches_.back().low[c] = lower(stretches_.back().low[c], value);
      stretches_.back().high[c] = higher(stretches_.back().high[c], value);
    }
  }
}

void TraceBuilder::halve() {
  for (std::size_t i = 0; i < stretches_.size() / 2; ++i) {
    Stretch& to = stretches_[i];
    const Stretch a = stretches_[2 * i], &b = stretches_[2 * i + 1];
    std::ranges::transform(a.low, b.low, to.low.begin(), lower);
    std::ranges::transform(a.high, b.high, to.high.begin(), higher);
  }
  stretches_.resize(stretches_.size() / 2);
  length_ *= 2;
  in_last_ = length_;
}

void plot_record(const data::RecordHeader& header, const TraceBuilder& traces,
                 const data::RecordOverview& overview, const std::vector<std::size_t>& shown,
                 const std::string& subtitle, const std::string& path) {
  const int rows = static_cast<int>(shown.size());
  const int height = rows * row_height + top_band + bottom_band;
  std::vector<ShownUnit> units;
  for (const std::size_t c : shown)
    units.push_back(header.channels[c].unit.empty()
                        ? ShownUnit{"?"}
                        : shown_unit(header.channels[c].unit, largest_of(traces, c)));
  std::string script = trace_block(header, traces, shown, units);
  if (overview.spectrum.segments > 0) script += spectrum_block(overview.spectrum, shown);
  script += std::string("set multiplot\nunset key\nset datafile missing 'nan'\n") + thin_grid +
            thin_axes +
            "set tics font ',8'\nset ylabel font ',8' offset 1,0\n"
            "set xlabel offset 0,0.6\nset ytics autofreq\nset style fill solid 1.0\n";
  script += titles(header.title, subtitle + shown_channels(header, shown), picture_width, height);
  for (int row = 0; row < rows; ++row) {
    const double top = 1.0 - static_cast<double>(top_band + name_band + row * row_height) / height;
    const auto k = static_cast<std::size_t>(row);
    script += row_script(header.channels[shown[k]], units[k], top,
                         top - static_cast<double>(row_height - name_band - 12) / height, k,
                         row + 1 == rows, traces.samples_per_stretch() == 1, overview.spectrum);
    script += "unset label 101\nunset label 102\n";
  }
  draw(path, picture_width, height, script + "unset multiplot\n");
}

}  // namespace hydrapod::report
