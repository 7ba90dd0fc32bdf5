#pragma once
#include <array>
#include <vector>

#include "pbrt/images/image.h"

namespace pbrt {

/// FLIP: how strongly the difference of two pictures is seen when one flips between them, in [0, 1] for every pixel.
/// Andersson et al. 2020, "FLIP: A Difference Evaluator for Alternating Images" (LDR); Andersson, Nilsson, Shirley,
/// Akenine-Moller 2021, "Visualizing Errors in Rendered High Dynamic Range Images" (HDR: the largest LDR value over
/// exposures from one that shows the brightest value to one that shows the median).
/// The pictures' R, G, B are taken as linear sRGB. Values that are not finite count as 0.
struct FlipSettings {
    /// 67: a 0.69 m wide screen of 3840 pixels seen from 0.70 m.
    double pixelsPerDegree = 67;
    bool hdr = false;  ///< false: values clamped to [0, 1]
};

/// Everything about the reference is worked out once; then any number of pictures can be compared with it.
/// Safe to use from several threads at once. Results do not depend on the number of threads.
class FlipReference {
  public:
    /// Throws UserError if a channel R, G or B is missing.
    explicit FlipReference(const Image &reference, const FlipSettings &settings = {});
    /// Mean over all pixels. `errorImage` (may be null) gets one channel, Y. Throws UserError if the resolution
    /// differs.
    double Compare(const Image &image, Image *errorImage = nullptr) const;
    /// log2 of the factors that pictures are multiplied with before tone mapping; empty unless `hdr`.
    const std::vector<double> &Exposures() const { return exposures_; }

    /// What the eye is given of one exposure of a picture.
    struct Percept {
        std::vector<std::array<float, 3>> lab;  ///< filtered, CIELAB with Hunt's adjustment
        std::vector<float> edge, point;         ///< lengths of the first and second derivative of the lightness
    };

  private:
    Percept See(const Image &image, double exposure) const;
    FlipSettings settings_;
    Point2i resolution_{0, 0};
    std::vector<double> exposures_;
    std::vector<Percept> percepts_;  ///< of the reference, one per exposure
};

}  // namespace pbrt
