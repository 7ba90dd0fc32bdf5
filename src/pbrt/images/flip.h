#pragma once
#include <vector>

#include "pbrt/images/image.h"

namespace pbrt {

/// FLIP: perceived difference, in [0, 1] per pixel, of two images when alternating between them. Andersson et al. 2020,
/// "FLIP: A Difference Evaluator for Alternating Images" (LDR); Andersson, Nilsson, Shirley, Akenine-Moller 2021,
/// "Visualizing Errors in Rendered High Dynamic Range Images" (HDR). HDR is the largest LDR value over exposures that
/// map the maximum to those that map the median. R, G, B are linear sRGB; non-finite values count as 0; images extend
/// with the nearest pixel.
struct FlipSettings {
    /// 67: a 0.69 m wide screen of 3840 pixels viewed from 0.70 m.
    double pixelsPerDegree = 67;
    /// false: values clamped to [0, 1]. true: exposures from the reference, ACES tone curve.
    bool hdr = false;
};

/// Preprocessed reference for any number of comparisons. Thread-safe; results are independent of the thread count.
class FlipReference {
  public:
    /// Throws UserError if channel R, G or B is missing.
    explicit FlipReference(const Image &reference, const FlipSettings &settings = {});
    /// Mean over all pixels. `errorImage` (may be null) gets channel Y. Throws UserError if the resolution differs or a
    /// channel is missing.
    double Compare(const Image &image, Image *errorImage = nullptr) const;
    /// log2 of the exposure factors, at most 16; empty unless `hdr`.
    const std::vector<double> &Exposures() const { return exposures_; }

  private:
    /// Perceptual representation of one exposure, as planes of pixels.
    struct Percept {
        std::vector<float> l, a, b;      ///< filtered, CIELAB with Hunt's adjustment
        std::vector<float> edge, point;  ///< norms of the first and second derivative of the lightness
    };
    /// Linear planes in the order R, G, B.
    static std::vector<float> Planes(const Image &image);
    Percept See(const std::vector<float> &planes, size_t exposure) const;
    float Difference(const Percept &reference, const Percept &test, size_t pixel) const;

    FlipSettings settings_;
    Point2i resolution_{0, 0};
    std::vector<double> exposures_;
    std::vector<Percept> percepts_;  ///< of the reference; one per exposure if `hdr`, else one
    double largestColorDifference_ = 0;
};

}  // namespace pbrt
