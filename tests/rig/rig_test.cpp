/// The rig's run and instruments.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>
#include <regex>
#include <string>
#include <vector>

#include "hydrapod/base/error.hpp"
#include "hydrapod/base/units.hpp"
#include "hydrapod/kinematics/legs.hpp"
#include "hydrapod/model/machine_file.hpp"
#include "hydrapod/rig/rig.hpp"
#include "support/run_program.hpp"

namespace hydrapod::test {
namespace {

using namespace rig;
using base::two_pi;

model::Machine starter() {
  return model::parse_machine(model::starter_machine_file(), "starter.toml").machine;
}

/// Keeps what is written.
class KeepingWriter final : public data::RecordWriter {
 public:
  explicit KeepingWriter(const data::RecordHeader& header) : RecordWriter(header, false) {}
  data::Samples all{};

 private:
  void write(const Eigen::Ref<const data::Samples>& samples) override {
    const Eigen::Index before = all.rows();
    all.conservativeResize(before + samples.rows(), samples.cols());
    all.bottomRows(samples.rows()) = samples;
  }
  std::string finish(bool /*complete*/) override { return {}; }
};

data::Samples measured(const RigOptions& options, const model::Machine& machine = starter()) {
  simulation::ClosedLoop loop(machine, machine.neutral(), loop_options(options));
  KeepingWriter writer({.channels = rig_channels(options), .sample_rate = options.rate});
  const auto result = run_rig(loop, options, writer);
  EXPECT_EQ(result.summary.end, simulation::RunEnd::finished) << result.summary.message;
  EXPECT_EQ(result.samples, writer.all.rows());
  return writer.all;
}

/// No excitation to speak of, sensors as asked for.
RigOptions at_rest() {
  RigOptions options;
  options.signals = {{.form = signals::White{}}};
  options.settling = 0.5;
  options.duration = 2.0;
  options.oversampling = 1;
  options.loop.ideal_sensors = true;
  return options;
}

double variance(const Eigen::Ref<const Eigen::VectorXd>& values) {
  return (values.array() - values.mean()).square().mean();
}

TEST(Rig, NoiseAndQuantisationHaveTheStatedVariance) {
  RigOptions options = at_rest();
  options.duration = 8.0;
  options.instruments.length = {.resolution = 4e-6, .noise = 3e-6};
  options.instruments.pressure = {.resolution = 0.0, .noise = 5e3};
  Accelerometer sensor{.name = "a", .noise_density = 2e-3, .bandwidth = 0.0};
  sensor.sensor = {};
  options.instruments.accelerometers = {sensor};
  const auto record = measured(options);
  const double n = static_cast<double>(record.rows());
  const double bound = 5.0 * std::sqrt(2.0 / n);           // five standard errors of a variance
  const double length = 3e-6 * 3e-6 + 4e-6 * 4e-6 / 12.0;  // noise, rounding
  for (int leg = 0; leg < 6; ++leg)
    EXPECT_NEAR(variance(record.col(12 + leg)) / length, 1.0, bound);
  for (int p = 0; p < 12; ++p) EXPECT_NEAR(variance(record.col(18 + p)) / 25e6, 1.0, bound);
  const double white = 2e-3 * 2e-3 * options.rate / 2.0;
  EXPECT_NEAR(variance(record.col(30)) / white, 1.0, bound);
}

TEST(Rig, NoiseHasItsDensityWithoutTheAntiAliasFilterToo) {
  RigOptions options = at_rest();
  options.duration = 8.0;
  options.oversampling = 3;
  options.instruments.anti_alias = false;
  Accelerometer sensor{.name = "a", .noise_density = 2e-3, .bandwidth = 0.0};
  sensor.sensor = {};
  options.instruments.accelerometers = {sensor};
  const auto record = measured(options);
  const double white = 2e-3 * 2e-3 * options.rate / 2.0;
  const double bound = 5.0 * std::sqrt(2.0 / static_cast<double>(record.rows()));
  EXPECT_NEAR(variance(record.col(30)) / white, 1.0, bound);
}

TEST(Rig, RangeSaturatesAndDropOutsAreMissing) {
  RigOptions options = at_rest();
  options.duration = 20.0;
  options.rate = 200.0;
  options.oversampling = 2;  // drop-outs are per second, however often the simulation is asked
  options.instruments.pressure = {.noise = 1e4, .low = 0.0, .high = 4e6};
  options.instruments.drop_outs = 0.5;
  options.instruments.accelerometers.clear();
  const auto record = measured(options);
  std::int64_t missing = 0;
  for (Eigen::Index k = 0; k < record.rows(); ++k)
    for (Eigen::Index c = 0; c < record.cols(); ++c) {
      if (c < 6) {
        ASSERT_FALSE(std::isnan(record(k, c)));  // what is demanded is known
      } else if (std::isnan(record(k, c))) {
        ++missing;
      } else if (c >= 18) {
        ASSERT_LE(record(k, c), 4e6);
        ASSERT_GE(record(k, c), 0.0);
      }
    }
  // 24 channels, 20 s, 0.5 per second, 4 samples each: 960 ± 5 standard deviations of 60
  EXPECT_NEAR(static_cast<double>(missing), 960.0, 300.0);
}

TEST(Rig, TheSameSeedGivesTheSameRecordBitForBit) {
  RigOptions options;
  options.signals = {{spatial::Vector6::Constant(1e-4), signals::Noise{0.0, 30.0}}};
  options.settling = 0.2;
  options.duration = 0.5;
  options.instruments.accelerometers = default_accelerometers(starter());
  const auto a = measured(options), b = measured(options);
  options.seed = 2;
  const auto c = measured(options);
  ASSERT_EQ(a.rows(), 500);
  ASSERT_EQ(a.cols(), static_cast<Eigen::Index>(rig_channels(options).size()));
  EXPECT_EQ((a - b).cwiseAbs().maxCoeff(), 0.0);
  EXPECT_GT((a - c).cwiseAbs().maxCoeff(), 0.0);
}

TEST(Rig, TheRecordShowsThePlannedExcitation) {
  RigOptions options = at_rest();
  options.oversampling = 2;  // with the anti-alias filter
  spatial::Vector6 levels;
  levels << 1.1e-4, 0.7e-4, 0.9e-4, 2.3e-4, 1.7e-4, 3.1e-4;
  options.signals = {{levels, signals::Multisine{1.0, 60.0, 2.0}}};
  options.settling = 1.0;
  options.duration = 4.0;
  const auto record = measured(options);
  // white noise at the controller's rate is recorded as it is: RMS within 2 %, spectrum flat
  options.signals = {{levels, signals::White{}}};
  const auto noise = measured(options);
  for (int i = 0; i < 6; ++i)
    EXPECT_NEAR(std::sqrt(variance(noise.col(i))), levels[i],
                5.0 * levels[i] / std::sqrt(2.0 * static_cast<double>(noise.rows())));
  constexpr double independent = 2.0 * 119.0;  // cosines and sines of the lines
  for (int i = 0; i < 6; ++i) {
    const double n = static_cast<double>(record.rows());
    EXPECT_NEAR(std::sqrt(record.col(i).squaredNorm() / n), levels[i], 0.02 * levels[i]);
    for (int j = i + 1; j < 6; ++j)
      EXPECT_LT(std::abs(record.col(i).dot(record.col(j))) / (n * levels[i] * levels[j]),
                5.0 / std::sqrt(independent));
  }
}

/// The platform follows slow sines; leg lengths and accelerometers must show what kinematics says.
TEST(Rig, InstrumentsShowTheMotion) {
  RigOptions options = at_rest();
  options.duration = 4.0;
  options.settling = 2.0;
  spatial::Vector6 rms = spatial::Vector6::Zero();
  rms[2] = 2e-3;  // z
  options.signals = {{rms, signals::Multisine{2.0, 2.0, 0.5}}};
  options.instruments.length = {};
  Accelerometer sensor{
      .name = "z", .p_P = {0.3, -0.2, 0.1}, .e_P = {0, 0, 1}, .noise_density = 0.0};
  sensor.sensor = {};
  options.instruments.accelerometers = {sensor};
  const auto record = measured(options);
  // amplitude of 2 Hz in leg 1 and in the accelerometer, from the record itself
  std::complex<double> leg = 0.0, acceleration = 0.0;
  for (Eigen::Index k = 0; k < record.rows(); ++k) {
    const auto turn = std::polar(2.0 / static_cast<double>(record.rows()),
                                 -two_pi * 2.0 * static_cast<double>(k) / options.rate);
    leg += record(k, 12) * turn;
    acceleration += record(k, 30) * turn;
  }
  const model::Machine machine = starter();
  const auto up = [&](double z) {
    spatial::Pose pose = machine.neutral();
    pose.p_BP.z() += z;
    return kinematics::leg_lengths(machine, pose)[0];
  };
  const double slope = (up(1e-5) - up(-1e-5)) / 2e-5;
  const double z = std::abs(leg) / slope;
  const double omega = two_pi * 2.0;
  EXPECT_GT(z, 1e-3);
  // the platform tilts a little as well: legs are not driven exactly alike
  EXPECT_NEAR(std::abs(acceleration) / (omega * omega * z), 1.0, 0.01);
  EXPECT_LT((leg / std::abs(leg) + acceleration / std::abs(acceleration)).real(), 0.02);
}

TEST(Rig, LevelsAreCheckedAgainstStrokeAndValves) {
  const model::Machine machine = starter();
  RigOptions options = at_rest();
  const auto excite = [](const std::string& text) {
    return signals::read_signals({text}, {.excitation = true});
  };
  options.signals = excite("multisine ry=5 deg, to=1 Hz, from=0.5, period=2");
  simulation::ClosedLoop loop(machine, machine.neutral(), loop_options(options));
  EXPECT_THAT(check_levels(loop, options), testing::IsEmpty());
  options.signals = excite("multisine ry=25 deg, to=1 Hz, from=0.5, period=2");
  const auto findings = check_levels(loop, options);
  ASSERT_FALSE(findings.empty());
  options.signals = excite("multisine x=8 mm, from=30, to=45 Hz, period=2");
  const auto fast = check_levels(loop, options);
  ASSERT_EQ(fast.size(), 2U);
  EXPECT_THAT(fast[0].message, testing::HasSubstr("the drive will be at its limit"));
  EXPECT_THAT(fast[1].message,
              testing::HasSubstr("kN in addition to the load: the motion will not follow"));
  EXPECT_EQ(fast[1].severity, base::Severity::warning);
  EXPECT_THAT(findings[0].message,
              testing::MatchesRegex("ry at this level needs [0-9.]+ mm of stroke in leg [1-6], "
                                    "[0-9.]+ mm left"));
  EXPECT_EQ(findings[0].severity, base::Severity::error);
}

/// With so large a gain and nothing that damps the oil the starter machine's loop is unstable, and
/// the rig sees its platform swing ever more.
TEST(Rig, SaysThatAMachineOscillatesByItself) {
  const auto with = [](const std::string& gain) {
    return model::parse_machine(model::starter_machine_file(), "starter.toml",
                                {"controller.feedback=none", "controller.bandwidth=" + gain})
        .machine;
  };
  auto options = at_rest();
  options.duration = 4.0;
  const auto swing = [&](const model::Machine& machine) {
    auto pushed = options;
    pushed.entry = Entry::wrench;
    pushed.signals = default_signals(Entry::wrench);
    const Eigen::VectorXd length = measured(pushed, machine).col(12);
    return variance(length.tail(1000)) / variance(length.head(1000));
  };
  for (const auto entry : {Entry::command, Entry::drive, Entry::wrench}) {
    options.entry = entry;
    options.signals = {{.form = signals::White{}}};
    const auto judged = [&](const std::string& gain) {
      const auto machine = with(gain);
      const simulation::ClosedLoop loop(machine, machine.neutral(), loop_options(options));
      return check_levels(loop, options);
    };
    EXPECT_THAT(judged("0.47"), testing::IsEmpty());
    const auto findings = judged("13.1");
    ASSERT_EQ(findings.size(), 1U);
    EXPECT_EQ(findings[0].severity, base::Severity::warning);
    EXPECT_THAT(
        findings[0].message,
        testing::MatchesRegex("the closed loop is unstable: it oscillates at [0-9.]+ Hz with "
                              "-[0-9.]+ % damping without excitation.*"));
  }
  EXPECT_GT(swing(with("13.1")), 10.0);
  EXPECT_LT(swing(with("0.47")), 4.0);
}

TEST(Accelerometers, StandAtTheJointsThatTheirNamesSay) {
  const auto machine = starter();
  const auto all = default_accelerometers(machine);
  ASSERT_EQ(all.size(), 9U);
  const std::array<std::string, 9> names{"1x", "1y", "1z", "3x", "3y", "3z", "5x", "5y", "5z"};
  for (std::size_t k = 0; k < all.size(); ++k) {
    EXPECT_EQ(all[k].name, "acceleration " + names[k]);
    EXPECT_EQ(all[k].point, names[k][0] - '0');
    EXPECT_EQ(all[k].p_P, machine.legs[2 * (k / 3)].platform_joint) << names[k];
    EXPECT_EQ(all[k].e_P, spatial::Vector3::Unit(names[k][1] - 'x')) << names[k];
  }
}

/// A tone at 0.45 of the record's rate, through the bilinear Butterworth filter of order 8 at 0.4:
/// |H|² = 1/(1 + (tan(π f T)/tan(π f_c T))^16), T of the simulation.
TEST(Rig, TonesBeyondTheCornerOfTheAntiAliasFilterAreWeakened) {
  RigOptions options = at_rest();
  options.rate = 125.0;
  options.oversampling = 4;
  options.entry = Entry::wrench;
  spatial::Vector6 force = spatial::Vector6::Zero();
  force[2] = 900.0;
  const double tone = 0.45 * options.rate;
  options.signals = {{force, signals::Sine{.frequency = tone}}};
  options.instruments.pressure = {};
  Accelerometer sensor{.name = "z", .e_P = {0, 0, 1}, .noise_density = 0.0, .bandwidth = 0.0};
  sensor.sensor = {};
  options.instruments.accelerometers = {sensor};
  const auto amplitude = [&](bool filtered) {
    options.instruments.anti_alias = filtered;
    const auto record = measured(options);
    std::complex<double> sum = 0.0;
    const Eigen::Index whole = 20 * (record.rows() / 20);  // 9 periods each
    for (Eigen::Index k = record.rows() - whole; k < record.rows(); ++k)
      sum += (record(k, 30) - record.col(30).mean()) *
             std::polar(2.0 / static_cast<double>(whole),
                        -two_pi * tone * static_cast<double>(k) / options.rate);
    return std::abs(sum);
  };
  const double fast = options.rate * options.oversampling;
  const double warped = std::tan(std::numbers::pi * tone / fast) /
                        std::tan(std::numbers::pi * 0.4 * options.rate / fast);
  const double plain = amplitude(false);
  EXPECT_GT(plain, 1e-3);
  EXPECT_NEAR(amplitude(true) / plain, 1.0 / std::sqrt(1.0 + std::pow(warped, 16)), 0.01);
}

TEST(Accelerometer, HasAWholeNumberForItsPlace) {
  EXPECT_EQ(parse_accelerometer("a, at=0.3 0 0.1, along=-y, point=17").point, 17);
  EXPECT_EQ(parse_accelerometer("a").point, 0);
  for (const char* wrong : {"at=0 0 1, along=z", "at=0.3 0 0.1", "along=z", "a, point=1e30",
                            "a, point=-1", "a, point=2.5", "a, point=nan"})
    EXPECT_THROW(parse_accelerometer(wrong), base::InputError) << wrong;
}

/// The numbers in a message.
std::vector<double> numbers_in(const std::string& message) {
  static const std::regex number("[0-9][0-9.e+]*");
  std::vector<double> all;
  for (std::sregex_iterator at(message.begin(), message.end(), number), end; at != end; ++at)
    all.push_back(std::stod(at->str()));
  return all;
}

/// Leg 1's length per z: the same for all legs of a symmetric machine.
double slope_along_z(const model::Machine& machine, const spatial::Pose& at) {
  const auto up = [&](double z) {
    spatial::Pose pose = at;
    pose.p_BP.z() += z;
    return kinematics::leg_lengths(machine, pose)[0];
  };
  return (up(1e-5) - up(-1e-5)) / 2e-5;
}

TEST(Rig, LevelsSayWhatIsNeededAndWhatIsThere) {
  const model::Machine machine = starter();
  RigOptions options = at_rest();
  spatial::Pose low = machine.neutral();
  low.p_BP.z() -= 0.05;
  const simulation::ClosedLoop below(machine, low, loop_options(options));
  spatial::Vector6 size = spatial::Vector6::Zero();
  size[2] = 0.7;
  options.signals = {{size, signals::Step{.at = 0.1, .rise = 0.3}}};
  const auto strokes = check_levels(below, options);
  ASSERT_FALSE(strokes.empty());
  const auto said = numbers_in(strokes[0].message);  // needed, leg, left
  ASSERT_EQ(said.size(), 3U) << strokes[0].message;
  const auto leg = static_cast<std::size_t>(said[1]) - 1;
  const auto& stops = below.plant().axis(static_cast<int>(leg)).stops;
  const double piston = kinematics::leg_lengths(machine, low)[leg] - machine.legs[leg].rod.length;
  EXPECT_LT(piston - stops.low, 0.9 * (stops.high - piston));  // below the middle
  EXPECT_NEAR(said[0], 700.0 * slope_along_z(machine, low), 0.01 * said[0]);
  EXPECT_NEAR(said[2], 1e3 * (piston - stops.low), 0.01 * said[2]);

  const simulation::ClosedLoop loop(machine, machine.neutral(), loop_options(options));
  size[2] = 0.02;
  options.signals = {{size, signals::Sine{30.0}}};
  const auto fast = check_levels(loop, options);
  ASSERT_FALSE(fast.empty());
  const auto forces = numbers_in(fast.back().message);  // needed, leg, available
  ASSERT_EQ(forces.size(), 3U) << fast.back().message;
  const double acceleration = 0.02 * std::pow(two_pi * 30.0, 2);
  EXPECT_NEAR(
      1e3 * forces[0],
      machine.platform.mass * acceleration / (6.0 * slope_along_z(machine, machine.neutral())),
      0.01 * 1e3 * forces[0]);
  const auto& axis = loop.parameters().axes[static_cast<std::size_t>(forces[1]) - 1];
  const double pull =
      axis.supply_pressure * axis.annulus_area - axis.return_pressure * axis.piston_area;
  EXPECT_GT(axis.load, 0.02 * pull);  // the weight helps to pull the platform down
  EXPECT_NEAR(1e3 * forces[2], pull + axis.load, 0.01 * 1e3 * forces[2]);

  options.entry = Entry::drive;
  for (int i = 0; i < 6; ++i) {  // a level of 1 is full drive of the leg that moves most
    size.setZero();
    size[i] = 2.0;
    options.signals = {{size, signals::Step{.at = 0.1}}};
    const auto drives = check_levels(loop, options);
    ASSERT_EQ(drives.size(), 1U);
    EXPECT_THAT(drives[0].message, testing::HasSubstr(" to 200 % of full drive"));
  }
}

TEST(Rig, PressuresAreThoseOfTheirChambers) {
  RigOptions options = at_rest();
  options.duration = 0.05;
  options.instruments.pressure = {};
  options.instruments.accelerometers.clear();
  const model::Machine machine = starter();
  const simulation::ClosedLoop loop(machine, machine.neutral(), loop_options(options));
  const auto record = measured(options);
  const auto& layout = loop.plant().layout();
  for (int leg = 0; leg < 6; ++leg) {
    const double cap = loop.rest().x[layout.cap(leg)], rod = loop.rest().x[layout.rod(leg)];
    EXPECT_GT(std::abs(cap - rod), 0.05 * cap);
    EXPECT_NEAR(record(0, 18 + 2 * leg), cap, 1e-3 * cap);
    EXPECT_NEAR(record(0, 19 + 2 * leg), rod, 1e-3 * rod);
  }
}

/// Settling, bandwidth and the record's rate, each with a simulation of another rate under it.
TEST(Rig, TimesAreThoseOfTheRecordHoweverFineTheSimulation) {
  RigOptions options = at_rest();
  options.oversampling = 4;
  options.settling = 0.6;
  options.duration = 0.5;
  options.entry = Entry::wrench;
  spatial::Vector6 size = spatial::Vector6::Zero();
  size[2] = 300.0;
  options.signals = {{size, signals::Sine{100.0}}};
  Accelerometer wide{.name = "wide", .e_P = {0, 0, 1}, .noise_density = 0.0, .bandwidth = 0.0};
  wide.sensor = {};
  Accelerometer narrow = wide;
  narrow.bandwidth = 100.0;
  options.instruments.accelerometers = {wide, narrow};
  const auto record = measured(options);
  std::complex<double> whole = 0.0, filtered = 0.0;
  for (Eigen::Index k = 0; k < record.rows(); ++k) {
    const auto turn = std::polar(1.0, -two_pi * 100.0 * static_cast<double>(k) / options.rate);
    whole += record(k, 30) * turn;
    filtered += record(k, 31) * turn;
  }
  const std::complex<double> at_corner(0.0, -1.0 / 1.4);  // 1/(2 ζ i), ζ = 0.7
  EXPECT_NEAR(std::abs(filtered / whole - at_corner), 0.0, 0.02);

  options.signals = {{size, signals::Step{.at = 0.7}}};
  options.duration = 0.2;
  const auto step = measured(options);
  const Eigen::VectorXd force = step.col(2);
  EXPECT_EQ(force.head(98).cwiseAbs().maxCoeff(), 0.0);
  EXPECT_EQ(force.tail(98).minCoeff(), 300.0);
}

TEST(LowPass, OfEighthOrderIsThreeDecibelsDownAtItsCorner) {
  constexpr double rate = 2000.0, corner = 400.0;
  const auto level = [&](double frequency) {
    LowPass filter = LowPass::butterworth(8, corner, rate);
    double squares = 0.0;
    for (int k = 0; k < 12000; ++k) {
      const double out = filter(std::sin(two_pi * frequency * k / rate));
      if (k >= 2000) squares += out * out;  // 5 s: whole cycles of all that is asked below
    }
    return std::sqrt(2.0 * squares / 10000.0);
  };
  EXPECT_NEAR(level(corner), std::sqrt(0.5), 1e-9);
  EXPECT_NEAR(level(100.0), 1.0, 1e-6);
  EXPECT_NEAR(level(701.0), std::pow(2.704, -8.0), 1e-5);  // tan(0.3505 π)/tan(0.2 π)
  LowPass settled = LowPass::butterworth(8, corner, rate);
  settled.settle(3.7);
  for (int k = 0; k < 100; ++k) EXPECT_NEAR(settled(3.7), 3.7, 1e-12);
}

}  // namespace
}  // namespace hydrapod::test
