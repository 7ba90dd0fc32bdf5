#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

// The interface to OpenImageIO. OpenImageIO depends on some 260 shared libraries, which take a quarter of a second to
// load: as much as a small render. So the code that calls it is a separate library (oiio_module.cpp), loaded when the
// first PNG is written, the first image is read that is neither EXR nor PFM, or the first texture goes to the tile
// cache. The two sides share plain data only; this header includes no other header of the project. Used inside this
// folder only.
namespace pbrt::oiio {

enum class ValueType { U8, U16, Half, Float };

/// An image in memory: rows from the top, channels interleaved.
struct Pixels {
    int width = 0, height = 0, channels = 0;
    ValueType type = ValueType::U8;
    const void *data = nullptr;
};

/// An image file of which the header was read.
class OpenFile {
  public:
    virtual ~OpenFile() = default;
    /// Reads all pixels as `type`, `channels` of them each. Alpha is not multiplied into the other channels.
    virtual void Read(void *pixels) = 0;

    int width = 0, height = 0, channels = 0;  ///< channels: how many are read; the file may have more
    ValueType type = ValueType::U8;           ///< U8, U16 (PNG only) or Float
    std::string format;                       ///< OpenImageIO's name of the format
    int orientation = 1;                      ///< EXIF numbering
    uint64_t minFileBytes = 0;                ///< a shorter file has lost pixels; 0: not known
};

/// Tiled files on disk, whose tiles are read when they are used and kept in memory up to a limit.
class TileStore {
  public:
    virtual ~TileStore() = default;
    /// Writes images of one type and number of channels to one file and returns its handle for GetTile. Throws
    /// std::runtime_error.
    virtual void *Add(const std::string &path, std::span<const Pixels> images) = 0;
    /// A tile that holds texel (x, y), in memory until it is released. Null if it cannot be read (see Error).
    virtual void *GetTile(void *file, int image, int x, int y) = 0;
    virtual const void *PixelsOf(void *tile) = 0;
    virtual void Release(void *tile) = 0;
    virtual std::string Error() = 0;
    /// Bytes of the tiles that are in memory.
    virtual size_t Bytes() = 0;
};

/// Every function throws std::runtime_error with OpenImageIO's message.
class ImageLibrary {
  public:
    virtual ~ImageLibrary() = default;
    /// Thread-safe, and so is reading the pixels of different files.
    virtual std::unique_ptr<OpenFile> Open(const std::string &path) const = 0;
    /// The bytes of a file in the format "png" or "jpeg"; the pixels are of type U8, encoded as sRGB.
    virtual std::vector<unsigned char> Encode(const std::string &format, const Pixels &pixels) const = 0;
    virtual std::unique_ptr<TileStore> MakeTileStore(int megabytes, int tileSize) const = 0;
};

/// Loads the library at the first call. Throws UserError if it cannot be loaded. Thread-safe.
const ImageLibrary &Library();

}  // namespace pbrt::oiio
