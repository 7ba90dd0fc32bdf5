#pragma once
#include <string>

#include "pbrt/images/image.h"

// ReadImage and WriteImage per file format, private to this folder. They throw UserError or their library's exceptions;
// ReadImage and WriteImage convert the latter to UserError.
namespace pbrt::formats {

ImageFile ReadExr(const std::string &path);
ImageFile ReadPfm(const std::string &path);
ImageFile ReadOther(const std::string &path, std::optional<ColorEncoding> encoding);

// Returns the bytes of a file; `path` is for messages only.
std::string EncodeExr(const std::string &path, const Image &image, const ImageMetadata &metadata);
/// 1 or 3 channels.
std::string EncodePfm(const Image &image);
/// `format` is "png" (1, 3 or 4 channels) or "jpeg" (1 or 3). Values become 8-bit sRGB (alpha too, as in stock).
std::string EncodeBytes(const std::string &format, const std::string &path, const Image &image);

/// Validates header sizes before pixels are allocated. Throws UserError if they exceed the memory, or the size of this
/// file at `maxExpansion` pixel bytes per file byte.
void CheckSize(const std::string &path, int64_t width, int64_t height, int64_t channels, int bytesPerValue,
               double maxExpansion);

}  // namespace pbrt::formats
