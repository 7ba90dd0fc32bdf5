#pragma once
#include <string>

#include "pbrt/scenefile/scene_description.h"

namespace pbrt {

/// Lower bound of a scene's memory before building: film sums; meshes, by parameters or file headers, with their
/// acceleration structure; images, by PNG headers and other files' sizes. Excludes curves, quadrics, displaced meshes,
/// volumes, lights and learned structures.
struct MemoryEstimate {
    double film = 0, meshes = 0, images = 0;  ///< bytes
    double triangles = 0;
    int imageCount = 0;
    FileLoc largestAt{};  ///< directive of the largest mesh or image
    double largest = 0;   ///< its bytes

    double Total() const { return film + meshes + images; }
    void See(double bytes, const FileLoc &at) {
        if (!(bytes > largest)) return;
        largest = bytes;
        largestAt = at;
    }
    /// "2.1 GB: meshes 1.9 GB (20 million triangles), 3 images 180 MB, film 59 MB".
    std::string Text() const;
};

/// `imagesInMemory` false: images are in the tile cache and excluded.
MemoryEstimate EstimateMemory(const SceneDescription &description, double filmBytes, bool imagesInMemory);

/// Throws UserError, at the largest directive, if the estimate exceeds this process's memory.
void RequireMemory(const MemoryEstimate &estimate);

}  // namespace pbrt
