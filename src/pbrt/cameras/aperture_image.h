#pragma once
#include "pbrt/core/files.h"
#include "pbrt/images/image.h"

namespace pbrt {

/// Transmittance over an aperture stop, scaled to the total of an open disk.
class ApertureImage {
  public:
    /// Empty: a disk.
    ApertureImage() = default;
    /// `image`: one channel, >= 0, not all black; row 0 is the bottom (-y).
    explicit ApertureImage(Image image);

    /// Built-in shape or image file `name`; empty if the name is empty. Throws UserError (no location).
    static ApertureImage Read(const std::string &name, const FileResolver &files);

    explicit operator bool() const { return bool(image_); }
    /// `p` in units of the stop's radius; 0 outside [-1, 1]^2.
    Float Lookup(const Point2 &p) const { return image_.Bilinear((p + Point2(1)) / Float(2), 0, WrapMode::Black); }
    /// Largest radius that passes light, in units of the stop's radius.
    Float Reach() const { return reach_; }

  private:
    Image image_;
    Float reach_ = 1;
};

}  // namespace pbrt
