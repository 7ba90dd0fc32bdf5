#pragma once
#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

// Interface to OpenImageIO, private to this folder. Loading its some 260 shared libraries takes a quarter of a second,
// as long as a small render. Hence oiio_module.cpp is a separate library, loaded on first use: PNG output, input other
// than EXR and PFM, or the tile cache. Only plain data crosses the interface, and this header includes no other project
// header.
namespace pbrt::oiio {

enum class ValueType { U8, U16, Half, Float };

/// Rows from the top, channels interleaved.
struct Pixels {
    int width = 0, height = 0, channels = 0;
    ValueType type = ValueType::U8;
    const void *data = nullptr;
};

class OpenFile {
  public:
    virtual ~OpenFile() = default;
    /// Reads all pixels as `type` with `channels` channels. Alpha is unassociated.
    virtual void Read(void *pixels) = 0;

    int width = 0, height = 0, channels = 0;  ///< channels: those that are read; the file may have more
    ValueType type = ValueType::U8;           ///< U8, U16 (PNG only) or Float
    std::string format;                       ///< OpenImageIO's format name
    int orientation = 1;                      ///< EXIF numbering
};

/// Tiled files on disk; tiles are loaded on demand and cached up to a limit.
class TileStore {
  public:
    virtual ~TileStore() = default;
    /// Writes images of one type and channel count to one file; returns its handle for GetTile. Throws
    /// std::runtime_error.
    virtual void *Add(const std::string &path, std::span<const Pixels> images) = 0;
    /// Tile with texel (x, y), kept in memory until released. Null on failure (see Error).
    virtual void *GetTile(void *file, int image, int x, int y) = 0;
    virtual const void *PixelsOf(void *tile) = 0;
    virtual void Release(void *tile) = 0;
    virtual std::string Error() = 0;
    virtual size_t Bytes() = 0;
};

/// All functions throw std::runtime_error with OpenImageIO's message.
class ImageLibrary {
  public:
    virtual ~ImageLibrary() = default;
    /// Thread-safe, as is reading pixels of different files.
    virtual std::unique_ptr<OpenFile> Open(const std::string &path) const = 0;
    /// Encodes U8 pixels, already sRGB, as "png" or "jpeg".
    virtual std::vector<unsigned char> Encode(const std::string &format, const Pixels &pixels) const = 0;
    virtual std::unique_ptr<TileStore> MakeTileStore(int megabytes, int tileSize) const = 0;
};

/// Loads the library at the first call; thread-safe. Throws UserError on failure.
const ImageLibrary &Library();

}  // namespace pbrt::oiio
