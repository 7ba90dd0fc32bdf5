#pragma once
#include <optional>
#include <vector>

#include "ext/octree/sky_tiles.h"

namespace ext {

/// What a cell of the octree knows of the tiles of one sky that it tells apart: a cut through the quadtree of tiles, by
/// rising key, and for each tile how many rays were traced from the cell and how many of them left the scene.
///
/// The estimate of the visible share v of a tile comes from its rays and kPrior more that bring what was known when
/// cell and tile were made: the estimate for the cell or tile that they were made from. Where a tile has few rays, that
/// is first scaled by what the rays of the region around it found: so a few rays that met a wall tell of all that lies
/// behind it.
///
/// Light samplers weigh tiles by E sqrt(v), sqrt(v) being the root mean square of what a shadow ray finds (0 or 1). The
/// sum over a cut is then the square root of the second moment of a choice among its tiles; that is what the cut keeps
/// low. A tile that is seen in part may hold parts that are seen and parts that are not: knowing them apart would lower
/// the sum from E sqrt(v) to E v. Such tiles are divided; four siblings that are equally visible are joined to make
/// room.
class SkyCut {
  public:
    /// The number of rays that what was known before counts for.
    static constexpr float kPrior = 1;
    /// After so many rays a tile is judged by its own rays alone.
    static constexpr float kEnough = 16;
    /// No tile's v is less: a weight of 0 would take the tile away for good.
    static constexpr float kLeast = 1e-10f;

    struct Tile {
        uint32_t number = 0;
        float before = 1, visible = 1;
        uint32_t traced = 0, left = 0;
        /// Beyond 2^32 rays only the share that left is kept.
        void Add(uint64_t moreTraced, uint64_t moreLeft) {
            moreTraced += traced, moreLeft += left;
            for (; moreTraced > std::numeric_limits<uint32_t>::max(); moreTraced /= 2) moreLeft /= 2;
            traced = static_cast<uint32_t>(moreTraced), left = static_cast<uint32_t>(moreLeft);
        }
    };
    SkyCut() = default;
    SkyCut(std::span<const uint32_t> numbers, float visible) {
        for (uint32_t n : numbers) tiles_.push_back({n, visible, visible, 0, 0});
    }

    explicit SkyCut(std::vector<Tile> tiles) : tiles_(std::move(tiles)) {}

    const std::vector<Tile> &Tiles() const { return tiles_; }
    void Add(size_t tile, uint64_t traced, uint64_t left) { tiles_[tile].Add(traced, left); }
    /// Finds v of all tiles. `near`: the cuts of the same sky in the cells around: where one of them sees a tile, this
    /// one may see it as well.
    void Estimate(const SkyTiles &sky, std::span<const SkyCut *const> near);
    /// Appends the tiles that Adapt will make by dividing others.
    void AppendChildren(const SkyTiles &sky, std::vector<uint32_t> *numbers) const;
    /// Divides and joins tiles, so that there are at most `most`. `sky` must know what AppendChildren says.
    void Adapt(const SkyTiles &sky, size_t most);
    /// The share of the sum of E sqrt(v) that could be saved by dividing the cell: of tiles that some rays found to be
    /// seen and some not.
    double GainOfDividingTheCell(const SkyTiles &sky) const;
    /// The same knowledge for a part of the cell: it is what was known before, and rays are counted from 0.
    SkyCut Inherited() const;

  private:
    /// The tile that holds the finest part with a key.
    const Tile &Holding(uint32_t key) const;
    struct Division {
        double gain;
        uint32_t number;  ///< of the tile
    };
    /// The tiles worth dividing, those of most gain first.
    std::vector<Division> ToDivide(const SkyTiles &sky) const;
    void Divide(uint32_t number);
    struct Joining {
        double cost;
        size_t first;  ///< index of the first of the four
    };
    /// The four siblings that are the cheapest to join, leaving out those that `divisions` are about.
    std::optional<Joining> CheapestToJoin(const SkyTiles &sky, std::span<const Division> divisions) const;
    void Join(size_t first, const SkyTiles &sky);

    std::vector<Tile> tiles_;
};

}  // namespace ext
