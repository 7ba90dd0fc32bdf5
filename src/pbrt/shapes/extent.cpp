#include "pbrt/shapes/extent.h"

#include "pbrt/shapes/triangle_mesh.h"

namespace pbrt {
namespace {

std::string PointText(const Point3 &p) { return fmt::format("({}, {}, {})", p.x, p.y, p.z); }

}  // namespace

Bounds3 TransformBounds(const Transform &t, const Bounds3 &b) {
    Bounds3 around;
    if (b.IsEmpty()) return around;
    for (int i = 0; i < 8; ++i) around = Union(around, t.Point(b.Corner(i)));
    return around;
}

Bounds3 BoundsOf(const Shape &shape) {
    Bounds3 all;
    if (const Mesh *mesh = Mesh::Of(shape)) {
        for (const Point3 &p : mesh->Data().p) all = Union(all, p);
        return all;
    }
    for (uint32_t i = 0; i < shape.PrimitiveCount(); ++i) all = Union(all, shape.PrimitiveBounds(i));
    return all;
}

void RequireReach(const std::string &what, const AnimatedTransform &place, const Bounds3 &b, const FileLoc &loc) {
    if (b.IsEmpty()) return;
    for (const Transform &t : {place.Start(), place.At(place.EndTime())})
        for (int i = 0; i < 8; ++i)
            if (const Point3 p = t.Point(b.Corner(i)); !IsWithinReach(p))
                throw UserError(loc, "{} reaches to {} after the transformation; coordinates must be {}.", what,
                                PointText(p), Text(kCoordinateRange));
}

void RequireReach(const std::string &what, const Shape &shape, const FileLoc &loc) {
    if (const Mesh *mesh = Mesh::Of(shape)) {
        const std::vector<Point3> &p = mesh->Data().p;
        for (size_t i = 0; i < p.size(); ++i)
            if (!IsWithinReach(p[i]))
                throw UserError(loc, "{}: vertex {} lies at {} after the transformation; coordinates must be {}.", what,
                                i, PointText(p[i]), Text(kCoordinateRange));
        return;
    }
    for (uint32_t i = 0; i < shape.PrimitiveCount(); ++i)
        RequireReach(what, Transform(), shape.PrimitiveBounds(i), loc);
}

}  // namespace pbrt
