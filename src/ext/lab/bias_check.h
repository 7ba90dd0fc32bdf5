#pragma once
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "ext/lab/tile_statistics.h"

namespace ext::lab {

/// Settings of the test whether the mean of a sampler's pictures is the reference. bias_check.cpp explains the method.
struct BiasSettings {
    double level = 0.005;    ///< chance of a false alarm in the whole check, if the noise is normal
    double interest = 0.03;  ///< "clean" claims that no bias of this size (relative) was overlooked
    int tileSize = 8;        ///< pixels
    /// Differences below these are never called a bias, however certain they are.
    double allowanceRegion = 0.01, allowanceImage = 0.002;
};

enum class BiasVerdict { Clean, Biased, Unknown };
const char *BiasVerdictName(BiasVerdict verdict);  ///< clean, biased, unknown

/// Further pictures of the same scene, neither runs nor reference, by the same sampler or by one that chooses lights in
/// the same way. They show how strong single samples can be where the runs met none; their mean is not used.
struct AuxiliaryRuns {
    std::vector<TileMeans> pictures;  ///< of equal weight; at least two, a single one is not used
    double sampleRatio = 1;           ///< samples per pixel of one of them over those of one run
};

/// The reference that the runs are compared with: at least one picture. The noise of the reference is estimated from
/// several pictures of equal weight (2 to 8 parts of the samples). If there is only one, it follows from `relL2`, the
/// expected error of the picture against the truth; without that, from the scatter of the differences.
struct BiasReference {
    std::vector<TileMeans> parts;
    std::optional<double> relL2;
    double sampleRatio = 1;                  ///< samples per pixel of one part over those of one run
    std::vector<AuxiliaryRuns> auxiliary{};  ///< further pictures of the sampler that made the reference
};

/// The test of one region of the picture in one channel.
struct RegionTest {
    int level = 0;  ///< 0: the smallest regions; every level doubles the side; the last one is the whole image
    Bounds2i pixels;
    int channel = 0;
    double difference = 0;  ///< relative: (runs - reference) / reference, mean over the smallest regions inside
    double standardError = 0, dof = 0;
    double p = 1;        ///< two-sided, of this test alone
    double floor = 0;    ///< largest |difference| that allowance, noise and unseen strong samples explain
    double visible = 0;  ///< smallest |difference| detected in 9 of 10 experiments
    bool biased = false;
};

struct BiasReport {
    BiasVerdict verdict = BiasVerdict::Unknown;
    int runs = 0, tiles = 0, tests = 0;
    RegionTest whole;           ///< channel with the smallest p of the whole image
    RegionTest worst;           ///< smallest p among the biased regions; among all regions if none is biased
    double pValue = 1;          ///< of `worst`, corrected for the number of tests
    double worstZ = 0;          ///< the normal deviate whose two-sided p is worst.p, with the sign of the difference
    double meanDifference = 0;  ///< relative, whole image: sum of all channels of runs over that of the reference, - 1
    /// Smallest detectable bias in the whole image, in half of the regions of about 1/16 of the image,
    /// and in half of the smallest regions (side in pixels). Infinity: none.
    double visibleImage = 0, visibleSixteenth = 0, visibleSmallest = 0;
    int smallestSide = 0;
    int sixteenthRegions = 0;  ///< number of regions of about 1/16; with fewer than 4 nothing is "clean"
    std::string text;          ///< one or two sentences for the user
};

/// `runs`: pictures of one sampler with different seeds, equal sample counts. All must have the grid and channels of
/// the reference (throws UserError). The reference must have other seeds. `auxiliary`: further pictures of the sampler
/// of the runs, in any order.
BiasReport CheckBias(std::span<const TileMeans> runs, const BiasReference &reference, const BiasSettings &settings = {},
                     std::span<const AuxiliaryRuns> auxiliary = {});

}  // namespace ext::lab
