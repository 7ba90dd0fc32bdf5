#pragma once
#include <vector>

#include "pbrt/images/image.h"

namespace pbrt {

/// FLIP: how strongly the difference of two pictures is seen when one flips between them, in [0, 1] for every pixel.
/// Andersson et al. 2020, "FLIP: A Difference Evaluator for Alternating Images" (LDR); Andersson, Nilsson, Shirley,
/// Akenine-Moller 2021, "Visualizing Errors in Rendered High Dynamic Range Images" (HDR: the largest LDR value over
/// exposures, from one that shows the brightest value to one that shows the median).
/// The pictures' R, G, B are taken as linear sRGB. Values that are not finite count as 0. Beyond its border a picture
/// continues with the nearest pixel.
struct FlipSettings {
    /// 67: a 0.69 m wide screen of 3840 pixels seen from 0.70 m.
    double pixelsPerDegree = 67;
    /// false: values clamped to [0, 1]. true: exposures chosen from the reference, ACES tone curve.
    bool hdr = false;
};

/// A reference, prepared once, with which any number of pictures can be compared. Several threads may compare at once.
/// Results do not depend on the number of threads.
class FlipReference {
  public:
    /// Throws UserError if a channel R, G or B is missing.
    explicit FlipReference(const Image &reference, const FlipSettings &settings = {});
    /// Mean over all pixels. `errorImage` (may be null) gets one channel, Y. Throws UserError if the resolution differs
    /// or a channel is missing.
    double Compare(const Image &image, Image *errorImage = nullptr) const;
    /// log2 of the factors that pictures are multiplied with before tone mapping, at most 16; empty unless `hdr`.
    const std::vector<double> &Exposures() const { return exposures_; }

  private:
    /// What an observer perceives of one exposure of a picture, as planes of pixels.
    struct Percept {
        std::vector<float> l, a, b;      ///< filtered, CIELAB with Hunt's adjustment
        std::vector<float> edge, point;  ///< lengths of the first and second derivative of the lightness
    };
    /// Linear planes, R G B one after the other.
    static std::vector<float> Planes(const Image &image);
    Percept See(const std::vector<float> &planes, size_t exposure) const;
    /// FLIP of one pixel.
    float Difference(const Percept &reference, const Percept &test, size_t pixel) const;

    FlipSettings settings_;
    Point2i resolution_{0, 0};
    std::vector<double> exposures_;
    std::vector<Percept> percepts_;  ///< of the reference; one per exposure if `hdr`, else one
    double largestColorDifference_ = 0;
};

}  // namespace pbrt
