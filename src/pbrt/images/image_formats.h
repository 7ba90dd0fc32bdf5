#pragma once
#include <string>

#include "pbrt/images/image.h"

// The parts of ReadImage and WriteImage, one per kind of file. Used inside this folder only. Readers and writers throw
// UserError or whatever their library throws; ReadImage and WriteImage turn the latter into UserError.
namespace pbrt::formats {

ImageFile ReadExr(const std::string &path);
void WriteExr(const std::string &path, const std::string &shownPath, const Image &image, const ImageMetadata &metadata);

ImageFile ReadPfm(const std::string &path);
/// 1 or 3 channels.
void WritePfm(const std::string &path, const Image &image);

/// Through OpenImageIO.
ImageFile ReadOther(const std::string &path, std::optional<ColorEncoding> encoding);
/// 1, 3 or 4 channels; values become 8-bit sRGB (alpha too, as in stock pbrt-v4).
void WritePng(const std::string &path, const std::string &shownPath, const Image &image);

}  // namespace pbrt::formats
