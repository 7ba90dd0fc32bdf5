#pragma once
#include <string>

#include "pbrt/images/image.h"

// The parts of ReadImage and WriteImage, one per kind of file. Used inside this folder only. They throw UserError or
// whatever their library throws; ReadImage and WriteImage turn the latter into UserError.
namespace pbrt::formats {

ImageFile ReadExr(const std::string &path);
ImageFile ReadPfm(const std::string &path);
/// All other formats, through OpenImageIO.
ImageFile ReadOther(const std::string &path, std::optional<ColorEncoding> encoding);

// The bytes of a file; `path` is for messages only.
std::string EncodeExr(const std::string &path, const Image &image, const ImageMetadata &metadata);
/// The image has 1 or 3 channels.
std::string EncodePfm(const Image &image);
/// `format` is "png" (1, 3 or 4 channels) or "jpeg" (1 or 3). Values become 8-bit sRGB (alpha too, as in stock
/// pbrt-v4).
std::string EncodeBytes(const std::string &format, const std::string &path, const Image &image);

/// To be called before memory is allocated for the pixels that a header announces. Throws UserError if they are too
/// many for this machine, or more than a file of this size can hold if every byte of it stands for at most
/// `maxExpansion` bytes of pixels.
void CheckSize(const std::string &path, int64_t width, int64_t height, int64_t channels, int bytesPerValue,
               double maxExpansion);

}  // namespace pbrt::formats
