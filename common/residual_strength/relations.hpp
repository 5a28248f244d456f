// Residual (liquefied) shear strength s_R by published correlations. Stresses in Pa; sigma_v0 is the vertical effective
// stress before the earthquake, compression positive; N60 = (N1)60, N60cs = (N1)60cs; p_a = 101.325 kPa;
// z = standard normal quantile of the wanted percentile (0: median). No caps here: strength_law.hpp has them.
#pragma once

namespace tailrun {

// Quantile of the standard normal distribution, `probability` in (0, 1).
double standard_normal_quantile(double probability);

// Weber (2015): S_50 = exp(0.1407 N60cs + 4.2399 x^0.120), x = sigma_v0/p_a, standard deviation
// N60cs^1.45 + 0.2 N60cs x^2.48 + 41.13, both in psf; normal, so small N and stress with z < 0 go below zero.
double weber_2015(double n60cs, double sigma_v0, double z = 0.0);

// The paper's two end points, 3.2 kPa at 17 kPa and 9.1 kPa at 186 kPa for N60cs = 6, through Weber's form:
// ln(s_R/kPa) = -2.8237 + 0.1407 N60cs + 3.8934 x^0.12.
double seed_fit(double n60cs, double sigma_v0);

// Kramer & Wang (2015) hybrid: p_a exp(-8.444 + 0.109 N60 + 5.379 x^0.1), lognormal; N60 without fines correction.
double kramer_wang_2015(double n60, double sigma_v0, double z = 0.0);
// Their standard deviation of ln s_R.
double kramer_wang_2015_deviation(double n60, double sigma_v0);

// Idriss & Boulanger (2008), SPT: ratio exp(N/16 + ((N - 16)/21.2)^3 - 3), N = N60cs-Sr; where void redistribution is
// negligible times 1 + exp(N/2.4 - 6.6). Ratios to sigma_v0.
double idriss_boulanger_spt_ratio(double n60cs_sr, bool void_redistribution);
// CPT: exp(q/24.5 - (q/61.7)^2 + (q/106)^3 - 4.42), q = q_c1Ncs-Sr; negligible: times 1 + exp(q/11.1 - 9.82).
double idriss_boulanger_cpt_ratio(double q_c1ncs_sr, bool void_redistribution);
// Seed (1987): increments of N and q_c1N for the fines content (percent), linear between 10, 25, 50 and 75 %.
double fines_increment_spt(double fines_content);
double fines_increment_cpt(double fines_content);

// Olson & Stark (2002): 0.03 + 0.0075 N60 (N60 <= 12) or 0.03 + 0.0143 q_c1 (MPa, <= 6.5), standard deviation 0.03.
double olson_stark_spt_ratio(double n60, double z = 0.0);
double olson_stark_cpt_ratio(double q_c1, double z = 0.0);  // q_c1 in Pa

// Robertson (2010): (0.02199 - 0.0003124 Q)/(1 - 0.02676 Q + 0.0001783 Q^2), at least 0.03; Q = Q_tn,cs <= 70.
double robertson_2010_ratio(double q_tncs);
// Robertson (2022), I_c < 3: 0.02 below Q = 20, 0.0007 exp(0.084 Q) + 0.3/Q up to 80.
double robertson_2022_ratio(double q_tncs);

}  // namespace tailrun
