#pragma once
#include <cstdint>
#include <string>

#include "pbrt/scenefile/scene_description.h"

namespace pbrt {

/// The least memory that a scene can need, as far as it is known before anything is built. It counts the sums of the
/// film; meshes, by their parameters or the heads of their files, with their acceleration structure; and images, by the
/// heads of PNG files and the sizes of others. It leaves out curves, quadrics, displaced meshes, volumes, lights and
/// what is learned of them.
struct MemoryEstimate {
    double film = 0, meshes = 0, images = 0;  ///< bytes
    double triangles = 0;
    int imageCount = 0;
    FileLoc largestAt{};  ///< the directive of the mesh or image that needs most
    double largest = 0;   ///< bytes of that one

    double Total() const { return film + meshes + images; }
    /// Keeps the place of the largest part.
    void See(double bytes, const FileLoc &at) {
        if (!(bytes > largest)) return;
        largest = bytes;
        largestAt = at;
    }
    /// "2.1 GB: meshes 1.9 GB (20 million triangles), 3 images 180 MB, film 59 MB".
    std::string Text() const;
};

/// `imagesInMemory` false: images are in the tile cache and do not count.
MemoryEstimate EstimateMemory(const SceneDescription &description, double filmBytes, bool imagesInMemory);

/// Throws UserError, at the directive that needs most, if the scene needs more memory than this process can use.
void RequireMemory(const MemoryEstimate &estimate);

}  // namespace pbrt
