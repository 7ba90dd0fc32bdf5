#pragma once
#include <span>
#include <unordered_map>

#include "ext/groups/emitter.h"

namespace ext {

/// What the tiles (SkyTile) of one sky are worth. G, the estimate of the light that would arrive from tile t if nothing
/// were in the way, is
///
///   G_t = E_t C(n, w_t)
///
/// where E_t is the integral of the radiance over the tile's solid angle (spectra become numbers by RootMeanSquare),
/// w_t the direction of its middle, and C the mean clamped cosine over a cone that holds the tile, as for lamps
/// (EmitterPacket): 0 exactly where the whole cone is below the horizon.
class SkyTiles {
  public:
    /// The coarsest tiles that are used: 16, up to 45 degrees from middle to corner.
    static constexpr uint32_t kMinLevel = 2;

    struct Tile {
        Float irradiance = 0;
        Vector3 direction{};
        Float sine = 0;  ///< of the half angle of a cone around the direction that holds the tile
    };

    /// `sky`: an index of lights.Skies().
    SkyTiles(const LightTable &lights, size_t sky);

    bool IsBlack() const { return !(whole_.m0 > 0); }
    LightId Sky() const { return lights_->Skies()[sky_]; }
    LightId IdOf(uint32_t number) const { return lights_->TileId(sky_, number); }
    /// Measures those of these tiles that are not known yet.
    void Know(std::span<const uint32_t> numbers);
    const Tile &At(uint32_t number) const { return tiles_.at(number); }

    /// The order of the quadtree: a key of a tile is that of its first part of the finest level, and `KeyTowards` the
    /// key of the finest part in a direction. A tile has KeyCount keys.
    static uint32_t KeyOf(uint32_t number) {
        const uint32_t level = SkyTile::LevelOf(number);
        return (number - SkyTile::FirstOf(level)) << 2 * (SkyTile::kMaxLevel - level);
    }
    static uint32_t KeyCount(uint32_t number) { return 1u << 2 * (SkyTile::kMaxLevel - SkyTile::LevelOf(number)); }
    uint32_t KeyTowards(const Vector3 &d) const {
        const Point2 st = (*lights_)[Sky()].Whole().SquareTowards(d);
        return SkyTile::At(SkyTile::kMaxLevel, st).Number() - SkyTile::FirstOf(SkyTile::kMaxLevel);
    }
    /// Some `count` tiles of about equal importance, half by their light, half by their size; by rising key.
    std::vector<uint32_t> FirstCut(size_t count);
    /// An estimate of G of the whole sky: positive everywhere, unless the sky is black.
    Float Unoccluded(const LightQuery &query) const { return whole_.m0 > 0 ? EvaluateFar(whole_, query) : Float(0); }
    /// True if the tile, its siblings and all tiles that they come from by division are known.
    bool KnowsAround(uint32_t number) const;
    /// The numbers of all tiles that are known, rising.
    std::vector<uint32_t> Known() const;
    size_t Bytes() const { return tiles_.size() * (sizeof(Tile) + 4 * sizeof(void *)); }

  private:
    Tile Measure(uint32_t number) const;

    const LightTable *lights_;
    size_t sky_;
    std::unordered_map<uint32_t, Tile> tiles_;  ///< by number
    Emitter whole_;                             ///< isFar, m0 and m1
};

}  // namespace ext
