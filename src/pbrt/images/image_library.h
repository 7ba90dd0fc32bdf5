#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

// What OpenImageIO does for us. It brings some 260 shared libraries, which take a quarter of a second to load: as much as
// a small render. So the code that calls it is a library of its own (oiio_module.cpp), loaded when the first PNG is
// written, the first image is read that is neither EXR nor PFM, or the first texture goes to the tile cache. The two
// sides share plain data only; this header includes nothing of ours. Used inside this folder only.
namespace pbrt::oiio {

enum class ValueType { U8, U16, Half, Float };

/// An image as it is in a file: rows from the top, channels interleaved.
struct Pixels {
    int width = 0, height = 0, channels = 0;
    ValueType type = ValueType::U8;
    const void *data = nullptr;
};

/// What was read. Alpha is not multiplied into the other channels. `format` is OpenImageIO's name.
struct File {
    Pixels pixels;  ///< of type U8, U16 (PNG only) or Float; the data are `values`
    std::vector<std::byte> values;
    std::string format;
    int orientation = 1;  ///< EXIF numbering
};

/// Tiled files on disk, of whose tiles as many are in memory as fit a limit.
class TileStore {
  public:
    virtual ~TileStore() = default;
    /// Writes images of one type and number of channels to one file; its name for GetTile. Throws std::runtime_error.
    virtual void *Add(const std::string &path, std::span<const Pixels> images) = 0;
    /// A tile that holds texel (x, y), in memory until it is released. Null if it cannot be read (Error says why).
    virtual void *GetTile(void *file, int image, int x, int y) = 0;
    virtual const void *PixelsOf(void *tile) = 0;
    virtual void Release(void *tile) = 0;
    virtual std::string Error() = 0;
    /// Bytes of tiles now in memory.
    virtual size_t Bytes() = 0;
};

/// Every function throws std::runtime_error with OpenImageIO's words.
class ImageLibrary {
  public:
    virtual ~ImageLibrary() = default;
    virtual File Read(const std::string &path) const = 0;
    /// 1, 3 or 4 channels of type U8, encoded as sRGB.
    virtual void WritePng(const std::string &path, const Pixels &pixels) const = 0;
    virtual std::unique_ptr<TileStore> MakeTileStore(int megabytes, int tileSize) const = 0;
};

/// Loads it at the first call. Throws UserError if it is not there. Thread-safe.
const ImageLibrary &Library();

}  // namespace pbrt::oiio
