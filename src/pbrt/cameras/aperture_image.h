#pragma once
#include "pbrt/core/files.h"
#include "pbrt/images/image.h"

namespace pbrt {

/// The share of light that each part of an aperture stop lets pass, in place of an open disk. Scaled so that in total
/// as much light passes as through the disk.
class ApertureImage {
  public:
    /// Empty: the stop is a disk.
    ApertureImage() = default;
    /// `image`: one channel, not negative, not all black; row 0 is the bottom (-y).
    explicit ApertureImage(Image image);

    /// The built-in shape or image file `name`; empty if the name is empty. Throws UserError (no location).
    static ApertureImage Read(const std::string &name, const FileResolver &files);

    explicit operator bool() const { return static_cast<bool>(image_); }
    /// `p` in units of the stop's radius; 0 outside of [-1, 1]^2.
    Float Lookup(const Point2 &p) const { return image_.Bilinear((p + Point2(1)) / Float(2), 0, WrapMode::Black); }
    /// No light passes farther than this from the centre, in units of the stop's radius.
    Float Reach() const { return reach_; }

  private:
    Image image_;
    Float reach_ = 1;
};

}  // namespace pbrt
