// SPDX-License-Identifier: LGPL-2.1-or-later
// The worked example of a plugin, built against an installation as its readers build it.
#include <cmath>
#include <nlohmann/json.hpp>

#include "support/command.hpp"

namespace {

namespace fs = std::filesystem;
using hexaplast::support::Command;
using hexaplast::support::content;
using hexaplast::support::Outcome;
using Json = nlohmann::json;

const std::string kExample = std::string(HEXAPLAST_SOURCE_DIR) + "/docs/examples/plugin";

std::string quoted(const std::string& path) { return std::string("'").append(path).append("'"); }

/// The command of the installation under `prefix`.
class OutsidePlugin : public Command {
 protected:
  Outcome installed(const std::string& arguments) {
    return shell(quoted(directory_ / "prefix" / HEXAPLAST_BIN / "hexaplast") + " " + arguments);
  }

  void must(const std::string& line) {
    const Outcome outcome = shell(line);
    ASSERT_EQ(outcome.code, 0) << line << "\n" << outcome.out << outcome.err;
  }
};

TEST_F(OutsidePlugin, IsBuiltFromTheInstallationAndFoundByName) {
  const std::string cmake = "'" HEXAPLAST_CMAKE "' ", scene = quoted(kExample + "/tether.scn");
  must(cmake + "--install '" HEXAPLAST_BUILD_DIR "' --prefix prefix");
  must(cmake + "-S " + quoted(kExample) +
       " -B build -DCMAKE_PREFIX_PATH=\"$PWD/prefix\" -DCMAKE_CXX_COMPILER='" HEXAPLAST_COMPILER "'");
  must(cmake + "--build build");

  EXPECT_EQ(installed("run " + scene).code, 6);
  EXPECT_EQ(installed("run " + scene + " --plugin-path build --final state.json").code, 0);

  // Every node of the cube moves alike, so that it is one mass on one spring, by the scheme of the solver:
  // (m + h^2 k) dv = h (-k (u - offset) - h k v).
  const Json state = Json::parse(content(directory_ / "state.json"));
  const double m = 4.0 / 8, k = 20, h = 0.01;
  double u = 0, v = 0;
  for (int step = 0; step < 50; ++step) {
    v += h * (-k * (u - 0.1) - h * k * v) / (m + h * h * k);
    u += h * v;
  }
  ASSERT_GT(u, 0.1);  // past the place it is drawn to
  for (int node = 0; node < 8; ++node) {
    EXPECT_NEAR(state["positions"][node][0], (node % 2) * 0.2 + u, 1e-12) << "node " << node;
    EXPECT_NEAR(state["velocities"][node][0], v, 1e-12) << "node " << node;
  }

  // installed beside the others it needs no path, and a scene that does not require it can be given it by name
  must(cmake + "--install build --prefix prefix");
  EXPECT_EQ(installed("run " + scene).code, 0);
  write("bare.scn", "<Node><TetherForceField/></Node>");
  EXPECT_EQ(installed("check bare.scn").code, 3);
  const Outcome named = installed("check bare.scn --plugin Tether");
  EXPECT_EQ(named.code, 3);
  EXPECT_EQ(named.err.find("unknown component"), std::string::npos) << named.err;
  const Outcome listed = installed("list TetherForceField --plugin Tether");
  EXPECT_EQ(listed.code, 0);
  EXPECT_NE(listed.out.find("stiffness: one number [N/m], must be > 0; default 1"), std::string::npos) << listed.out;
  EXPECT_EQ(installed("run " + scene + " --set cube/TetherForceField1.stiffness=-1").code, 2);
}

}  // namespace
