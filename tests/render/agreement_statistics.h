#pragma once
#include <string>
#include <vector>

#include "pbrt/build/built_scene.h"
#include "pbrt/images/image.h"

namespace pbrt::test {

/// Two-sided p-value of Student's t.
double StudentTail(double t, double dof);

/// Sums and sums of squares of every pixel and channel over independent renders of one view. Pixels are independent too
/// (sampler "independent" or "paddedsobol", every sample goes to its own pixel), so the variance of a mean over pixels
/// is known from few renders.
class PixelStatistics {
  public:
    void Add(const Image &image);
    int Runs() const { return runs_; }
    Point2i Resolution() const { return resolution_; }

    /// Mean of a channel over a block of pixels, its variance, and how well that variance is known
    /// (Welch-Satterthwaite).
    struct Mean {
        double value = 0, variance = 0, dof = 1;
    };
    Mean Of(const Bounds2i &block, int channel) const;

  private:
    Point2i resolution_{0, 0};
    int runs_ = 0;
    std::vector<double> sum_, squares_;
};

/// One set of renders against the pool of others: Welch's t-test for every channel of every block of pixels.
struct Agreement {
    double difference = 0, error = 0;  ///< of the image mean, relative: and its standard error
    double worstP = 1;
    double level = 0;   ///< Sidak's, for each of all blocks, channels and `comparisons`
    std::string worst;  ///< block and channel
    bool Agrees() const { return worstP > level; }
};

/// Blocks of 16 and of 48 pixels, where less than 1 % is let pass, and the whole image.
Agreement Compare(const PixelStatistics &one, const std::vector<const PixelStatistics *> &others, size_t comparisons,
                  double alpha);

/// Renders with independent samples: then pixels are independent too, and the variances of tiles are known.
Image RenderIndependently(const BuiltScene &built, Integrator &integrator, int samplesPerPixel, int seed);

}  // namespace pbrt::test
