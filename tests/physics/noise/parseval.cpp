// SPDX-License-Identifier: BSD-3-Clause
// Power is conserved whatever moves (docs/theory/spectra.md, eq. 7.10), and what share of a bin is first order.
#include "physics/noise/support.hpp"

namespace straytrace::testing {
namespace {

// All bins plus the constant part; the first bin begins at `low`, below which the PSD continues.
double power_of(PhaseSpectra const& spectra, PhaseSpectrum const& s) {
  FrequencyGrid const& grid = spectra.grid();
  double sum = s.constant + s.psd[0] * grid.edges[0];
  for (std::size_t i = 0; i < grid.size(); ++i) sum += s.psd[i] * grid.width(i);
  return sum;
}

TEST(Parseval,
     HoldsForEveryStrengthAndKindOfMotion) {  // tolerance 1e-4 for what lies below the bins, 1e-6 for all lines
  MotionClass const line{gaussian_line(2, 0.3, 1), 0, {}}, law{power_law_asd(1, 1, -2, 1, 100), 0, {}},
      cross{power_law_asd(1, 1, -1.5, 1, 100), 0, {}};
  MotionClass const tone_class{{}, 1.7, {}};
  MotionClass drift_class{{}, 0, {}};
  drift_class.drift = true;
  std::vector<double> edges = {0.01, 0.02, 0.1};
  while (edges.back() < 3000) edges.push_back(edges.back() * 1.3);
  PhaseSpectra const spectra({line, law, tone_class, drift_class, cross}, FrequencyGrid{edges});
  double const turn = std::pow(2 * pi * 30, 2), of_law = 1 / law.variance();
  for (std::vector<double> const& kappa : std::vector<std::vector<double>>{{1e-6, 0, 0, 0, 0},
                                                                           {1, 0, 0, 0, 0},
                                                                           {300, 0, 0, 0, 0},
                                                                           {0, 10 * of_law, 0, 0, 0},
                                                                           {0, 0, 1e-5, 0, 0},
                                                                           {0, 0, 40, 0, 0},
                                                                           {3, of_law, 9, 0, 0},
                                                                           {1e-5, of_law, 1e-5, 0, 0},
                                                                           {0, 0, 0, turn, 0},
                                                                           {2, 1e-5 * of_law, 4, turn, 0},
                                                                           {1, 4 * of_law, 0, 0, -of_law}}) {
    PhaseSpectrum const s = spectra(kappa);
    EXPECT_NEAR(power_of(spectra, s), 0.5, 1e-4) << kappa[0] << ' ' << kappa[1] << ' ' << kappa[2] << ' ' << kappa[3];
    EXPECT_NEAR(s.total, 0.5, 0.5e-6);
    if (kappa[0] == 1) {
      EXPECT_GT(std::fabs(power_of(spectra, s) - s.constant - 0.5), 1e-3);  // control: without the unmoved light
    }
  }
}

// Strong slow motion under a quiet body: bins of the slow body's fringes are wrapped, those of the quiet one linear.
TEST(LinearShare, DistinguishesWrappingFromLinearCoupling) {
  Spectrum const slow = gaussian_line(0.2, 0.05, 2e-6), quiet = power_law_asd(1e-16, 100, -1, 20, 1000);
  auto const share = [](MotionSet const& m) {
    CouplingTable const t = known_table({known_class(1, 1, {record(0, 1, {phase_sensitivity(0, 2, two_k)})})});
    return project_noise(t, m, UnitDetector(), on({5, 5.2, 300, 310})).routes[0].linear_share;
  };
  std::vector<double> const both = share(moving({slow + quiet})), weak = share(moving({slow.scaled(1e-12) + quiet}));
  EXPECT_LT(both[0], 1e-9);
  EXPECT_GT(both[2], 0.99);
  EXPECT_TRUE(std::isnan(weak[0]));  // nothing moves there
  EXPECT_GT(weak[2], 0.9999);
  EXPECT_TRUE(std::isnan(share(moving({quiet.scaled(0)}))[0]));
}

}  // namespace
}  // namespace straytrace::testing
