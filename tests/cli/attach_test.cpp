/// `hydrapod attach`, and what the commands say of a machine whose payload swings.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "hydrapod/exchange/exchange.hpp"
#include "hydrapod/model/machine_file.hpp"
#include "support/beam_payload.hpp"
#include "support/run_program.hpp"
#include "support/universal_text.hpp"

namespace hydrapod {
namespace {

using test::run_hydrapod;
using testing::HasSubstr;

class Attach : public testing::Test {
 protected:
  Attach() {
    const auto [M, K] = test::mast_matrices({});
    test::write_text(folder_ / "K.mtx", exchange::matrix_market(K, {"mast"}));
    test::write_text(folder_ / "M.mtx", exchange::matrix_market(M, {"mast"}));
    test::write_text(folder_ / "machine.toml", model::starter_machine_file());
  }
  [[nodiscard]] test::RunResult run(const std::vector<std::string>& arguments) const {
    return run_hydrapod(arguments, {.folder = folder_.path()});
  }

  test::TemporaryFolder folder_;
};

TEST_F(Attach, WritesAMachineThatHasTheModes) {
  const auto attached =
      run({"attach", "machine.toml", "--stiffness", "K.mtx", "--mass", "M.mtx", "--at", "0,0,0.1",
           "--modes", "2", "--damping-ratio", "3 %", "--add-mass", "-o", "mast.toml"});
  ASSERT_EQ(attached.exit_code, 0) << attached.err;
  EXPECT_THAT(attached.out, HasSubstr("mode_1"));
  EXPECT_THAT(attached.out, HasSubstr("modes from"));  // what is left out is told
  const auto modes = run({"modes", "mast.toml", "--format", "json"});
  ASSERT_EQ(modes.exit_code, 0) << modes.err;
  const auto json = nlohmann::json::parse(modes.out);
  const auto& coordinates = json["coordinates"];
  EXPECT_EQ(coordinates.back(), "payload.mode_2");
  double payload = 0.0;
  for (const auto& mode : json["modes"])
    payload = std::max(payload, mode["strain_energy"].value("payload", 0.0));
  EXPECT_GT(payload, 0.5);
  EXPECT_THAT(run({"modes", "mast.toml"}).out, HasSubstr("2 coordinates of the payload"));
}

TEST_F(Attach, ReadsTheSameFromAUniversalFile) {
  const auto [M, K] = test::mast_matrices({});
  test::write_text(folder_ / "mast.unv",
                   test::matrix_dataset(131, M) + test::matrix_dataset(139, K));
  const std::vector<std::string> rest{"--at",    "0,0,0.1", "--add-mass",
                                      "--force", "-o",      "mast.toml"};
  const auto with = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.end(), rest.begin(), rest.end());
    const auto attached = run(arguments);
    EXPECT_EQ(attached.exit_code, 0) << attached.err;
    return attached.out;
  };
  EXPECT_EQ(with({"attach", "machine.toml", "--uff", "mast.unv"}),
            with({"attach", "machine.toml", "--stiffness", "K.mtx", "--mass", "M.mtx"}));
}

TEST_F(Attach, SaysWhatDoesNotFit) {
  const auto heavy = run({"attach", "machine.toml", "--stiffness", "K.mtx", "--mass", "M.mtx",
                          "--set", "platform.mass=20 kg", "-o", "mast.toml"});
  EXPECT_EQ(heavy.exit_code, 2);
  EXPECT_THAT(heavy.err, HasSubstr("--add-mass"));
  test::write_text(folder_ / "M.mtx", "%%MatrixMarket matrix array real symmetric\n2 2\n1\n");
  const auto broken =
      run({"attach", "machine.toml", "--stiffness", "K.mtx", "--mass", "M.mtx", "-o", "mast.toml"});
  EXPECT_EQ(broken.exit_code, 2);
  EXPECT_THAT(broken.err, HasSubstr("M.mtx:3"));
  const auto neither = run({"attach", "machine.toml", "-o", "mast.toml"});
  EXPECT_EQ(neither.exit_code, 2);
  EXPECT_THAT(neither.err, HasSubstr("--stiffness"));
  const auto both =
      run({"attach", "machine.toml", "--uff", "K.mtx", "--punch", "K.mtx", "-o", "m.toml"});
  EXPECT_EQ(both.exit_code, 2);
  EXPECT_THAT(both.err, HasSubstr("--uff"));
  const auto none = run({"attach", "machine.toml", "--uff", "K.mtx", "-o", "m.toml"});
  EXPECT_EQ(none.exit_code, 2);
  EXPECT_THAT(none.err, HasSubstr("K.mtx: error: this is no Universal File"));
}

}  // namespace
}  // namespace hydrapod
