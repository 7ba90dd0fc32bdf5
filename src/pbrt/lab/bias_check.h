#pragma once
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "pbrt/lab/tile_statistics.h"

namespace pbrt::lab {

/// Is the mean of a sampler's pictures the reference? bias_check.cpp explains the method.
struct BiasSettings {
    double level = 0.005;    ///< chance of a false alarm in the whole check, if the noise is normal
    double interest = 0.03;  ///< "clean" claims that no bias of this size (relative) was overlooked
    int tileSize = 8;        ///< pixels
    /// Differences below these are never called a bias, however certain they are.
    double allowanceRegion = 0.01, allowanceImage = 0.002;
};

enum class BiasVerdict { Clean, Biased, Unknown };
const char *BiasVerdictName(BiasVerdict verdict);  ///< clean, biased, unknown

/// Pictures of the same scene by the sampler in question, or by one that chooses lights in the same way, which are
/// neither the runs nor the reference: they tell how strong single samples can be where the runs met none. Their mean
/// is not looked at.
struct BiasKin {
    std::vector<TileMeans> pictures;  ///< of equal weight; a single one tells nothing
    double sampleRatio = 1;           ///< samples per pixel of one of them over those of one run
};

/// What the runs are compared with: at least one picture. Several of equal weight (2 to 8 parts of the samples) tell
/// the noise of their mean. With one only, `relL2` (its expected one against the truth) does; if that is missing too,
/// the noise is taken from the scatter of the differences.
struct BiasReference {
    std::vector<TileMeans> parts;
    std::optional<double> relL2;
    double sampleRatio = 1;      ///< samples per pixel of one part over those of one run
    std::vector<BiasKin> kin{};  ///< of the sampler that made it
};

/// One part of the picture and one channel.
struct RegionTest {
    int level = 0;  ///< 0 smallest regions; every level doubles the side; the last is the whole image
    Bounds2i pixels;
    int channel = 0;
    double difference = 0;  ///< relative: (runs - reference) / reference, mean over the smallest regions inside
    double standardError = 0, dof = 0;
    double p = 1;        ///< two-sided, of this test alone
    double floor = 0;    ///< largest |difference| that allowance, noise and unseen strong samples explain
    double visible = 0;  ///< smallest |difference| that would have been called a bias in 9 of 10 campaigns
    bool biased = false;
};

struct BiasReport {
    BiasVerdict verdict = BiasVerdict::Unknown;
    int runs = 0, tiles = 0, tests = 0;
    RegionTest whole;           ///< channel with the smallest p of the whole image
    RegionTest worst;           ///< smallest p among the biased ones; among all if there are none
    double pValue = 1;          ///< of `worst`, corrected for the number of tests
    double worstZ = 0;          ///< the normal deviate with worst.p, with the sign of the difference
    double meanDifference = 0;  ///< relative, whole image: sum of all channels of runs over that of the reference, - 1
    /// Smallest bias that could have been seen in the whole image, in half of the regions of about 1/16 of the image,
    /// and in half of the smallest regions (side in pixels). Infinity: none.
    double visibleImage = 0, visibleSixteenth = 0, visibleSmallest = 0;
    int smallestSide = 0,
        sixteenthRegions =
            0;  ///< how many of "about 1/16" there are; fewer than 4 (small pictures, few runs) are never "clean"
    std::string text;  ///< one or two sentences for people
};

/// `runs`: pictures of one sampler with different seeds, equal sample counts. All must have the grid and channels of
/// the reference (throws UserError). The seeds of the reference must be others. `kin`: of the runs, in any order.
BiasReport CheckBias(std::span<const TileMeans> runs, const BiasReference &reference, const BiasSettings &settings = {},
                     std::span<const BiasKin> kin = {});

}  // namespace pbrt::lab
