#pragma once
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "ext/lab/tile_statistics.h"

namespace ext::lab {

/// Settings of the bias test of a sampler's images against the reference. Method: bias_check.cpp.
struct BiasSettings {
    double level = 0.005;    ///< false alarm probability of the whole check, for normal noise
    double interest = 0.03;  ///< "clean" rules out a relative bias of this size
    /// Differences below these are never called a bias, regardless of significance.
    double allowanceRegion = 0.01, allowanceImage = 0.002;
};

enum class BiasVerdict { Clean, Biased, Unknown };
const char *BiasVerdictName(BiasVerdict verdict);  ///< clean, biased, unknown
std::string PercentText(double v);  ///< detection limit for the user; "none" if infinite, "more than 1000 %" above

/// Additional images of the same scene, neither runs nor reference, by the same sampler or one with the same light
/// selection. They indicate the strength of single samples where the runs had none; their mean is not used.
struct AuxiliaryRuns {
    std::vector<TileMeans> pictures;  ///< of equal weight; at least two, else unused
    double sampleRatio = 1;           ///< their samples per pixel over those of one run
};

/// Reference of the comparison: at least one image. Its noise is estimated from several images of equal weight (2 to 8
/// parts of the samples). For a single one, it follows from `relL2`, its expected error, or without that from the
/// scatter of the differences.
struct BiasReference {
    std::vector<TileMeans> parts;
    std::optional<double> relL2;
    double sampleRatio = 1;                  ///< samples per pixel of one part over those of one run
    std::vector<AuxiliaryRuns> auxiliary{};  ///< additional images of the reference's sampler
};

/// Test of one channel in one region of the image: t = difference / standardError with `dof` degrees of freedom.
struct RegionTest {
    int level = 0;  ///< 0: the smallest regions; every level doubles the side; the last is the whole image
    Bounds2i pixels;
    int channel = 0;
    double difference = 0;  ///< relative: (runs - reference) / reference, mean over the smallest regions inside
    double standardError = 0, dof = 0;
    double p = 1;        ///< two-sided, of this test alone
    double floor = 0;    ///< largest |difference| explained by allowance, noise and missed strong samples
    double visible = 0;  ///< smallest |difference| detected with probability 0.9
    bool biased = false;
};

struct BiasReport {
    BiasVerdict verdict = BiasVerdict::Unknown;
    int tiles = 0, tests = 0;
    RegionTest whole;           ///< smallest p over channels, for the whole image
    RegionTest worst;           ///< smallest p of the biased regions; of all regions if none is biased
    double pValue = 1;          ///< of `worst`, corrected for multiple tests
    double worstZ = 0;          ///< normal deviate of two-sided p worst.p, with the sign of the difference
    double meanDifference = 0;  ///< relative, whole image: channel sum of runs over that of the reference, - 1
    /// Smallest detectable bias: in the whole image, in half of the regions of about 1/16 of the image, and in half of
    /// the smallest regions (side in pixels). Infinity: none.
    double visibleImage = 0, visibleSixteenth = 0, visibleSmallest = 0;
    int smallestSide = 0;
    int sixteenthRegions = 0;  ///< number of regions of about 1/16; fewer than 4 are never "clean"
    std::string text;          ///< one or two sentences for the user
};

/// `runs`: images of one sampler with different seeds and equal sample counts, with the reference's grid and channels
/// (else throws UserError). The reference must use other seeds. `auxiliary`: additional images of the runs' sampler, in
/// any order.
BiasReport CheckBias(std::span<const TileMeans> runs, const BiasReference &reference, const BiasSettings &settings = {},
                     std::span<const AuxiliaryRuns> auxiliary = {});

}  // namespace ext::lab
