#include "pbrt/shapes/curves.h"

#include "pbrt/core/error.h"

namespace pbrt {

size_t SegmentCount(size_t count, int degree, CurveBasis basis) {
    PBRT_CHECK(degree == 2 || degree == 3);
    auto d = size_t(degree);
    if (count < d + 1) return 0;
    if (basis == CurveBasis::BSpline) return count - d;
    return (count - 1) % d == 0 ? (count - 1) / d : 0;
}

CubicBezier SegmentOf(std::span<const Point3> points, size_t index, int degree, CurveBasis basis) {
    if (degree == 3) {
        if (basis == CurveBasis::Bezier) {
            const Point3 *p = &points[3 * index];
            return {{p[0], p[1], p[2], p[3]}};
        }
        // Blossoms of the spline with knots -2..3 about the segment [0, 1]: b(0,0,0), b(0,0,1), b(0,1,1), b(1,1,1).
        const Point3 *p = &points[index];
        constexpr Float kThird = Float(1) / 3;
        Point3 b01 = Lerp(kThird, p[1], p[2]), b10 = Lerp(kThird, p[2], p[1]);
        return {
            {(Lerp(kThird, p[1], p[0]) + b01) * Float(0.5), b01, b10, (b10 + Lerp(kThird, p[2], p[3])) * Float(0.5)}};
    }
    const Point3 *p = &points[basis == CurveBasis::Bezier ? 2 * index : index];
    Point3 a = p[0], b = p[1], c = p[2];
    if (basis == CurveBasis::BSpline) {
        a = (a + b) * Float(0.5);
        c = (b + c) * Float(0.5);
    }
    constexpr Float kTwoThirds = Float(2) / 3;
    return {{a, Lerp(kTwoThirds, a, b), Lerp(kTwoThirds, c, b), c}};
}

namespace {

Float WidthAt(const Curves::Segment &s, Float u) { return Lerp(u, s.width0, s.width1); }

Vector3 SomePerpendicular(const Vector3 &v) {
    Float length = Length(v);
    if (!(length > 0)) return {1, 0, 0};
    Vector3 s, t;
    CoordinateSystem(v / length, &s, &t);
    return s;
}

/// Unit vector along a x b, or any perpendicular to b if a x b vanishes.
Vector3 UnitCross(const Vector3 &a, const Vector3 &b) {
    Vector3 c = Cross(a, b);
    Float length = Length(c);
    return length > 0 ? c / length : SomePerpendicular(b);
}

/// Tangent at u; the chord where control points coincide.
Vector3 Tangent(const CubicBezier &c, Float u) {
    Vector3 t = c.Derivative(u);
    return LengthSquared(t) > 0 ? t : c.p[3] - c.p[0];
}

}  // namespace

Curves::Curves(CurveKind kind, std::vector<Segment> segments, std::vector<Normal3> normals,
               const Transform &renderFromObject, bool reverseOrientation)
    : Shape(ShapeKind::Curves), kind_(kind), segments_(std::move(segments)), normals_(std::move(normals)),
      normalSide_(reverseOrientation ? Float(-1) : Float(1)) {
    PBRT_CHECK(normals_.size() == (kind == CurveKind::Ribbon ? 2 * segments_.size() : 0));
    const std::optional<double> uniform = renderFromObject.UniformScale(1e-5);
    isPlaced_ = uniform.has_value();
    if (isPlaced_) {
        const auto scale = Float(*uniform);
        for (Segment &s : segments_) {
            for (Point3 &p : s.curve.p) p = renderFromObject.Point(p);
            s.width0 *= scale;
            s.width1 *= scale;
        }
        for (Normal3 &n : normals_) n = renderFromObject.Normal(n);
        errorOfWidth_ = Vector3(0);
        for (int axis = 0; axis < 3; ++axis) {
            Vector3 unit(0);
            unit[axis] = 1 / scale;
            errorOfWidth_ += Abs(renderFromObject.Vector(unit));
        }
        if (renderFromObject.SwapsHandedness()) side_ = -1;
    } else {
        renderFromSegments_ = renderFromObject;
    }
    for (Normal3 &n : normals_) n = LengthSquared(n) > 0 ? Normalize(n) : Normal3(0, 0, 1);
    for (size_t i = 0; i < segments_.size(); ++i) AddPieces(segments_[i], i, &pieces_);
    pieces_.shrink_to_fit();
}

bool Curves::Append(const Curves &other) {
    if (kind_ != other.kind_ || side_ != other.side_ || normalSide_ != other.normalSide_ ||
        isPlaced_ != other.isPlaced_ || errorOfWidth_ != other.errorOfWidth_ ||
        !(renderFromSegments_ == other.renderFromSegments_))
        return false;
    size_t first = segments_.size();
    if (first + other.segments_.size() >= size_t(1) << 27) return false;
    segments_.insert(segments_.end(), other.segments_.begin(), other.segments_.end());
    normals_.insert(normals_.end(), other.normals_.begin(), other.normals_.end());
    for (Piece p : other.pieces_) {
        p.segment = (p.segment + uint32_t(first)) & 0x7ffffffu;
        pieces_.push_back(p);
    }
    return true;
}

/// Splits while that reduces the boxes' surface area by at least 30 %: at most 8 pieces, and no more than stock.
void Curves::AddPieces(const Segment &segment, size_t index, std::vector<Piece> *pieces) {
    auto surface = [&](uint32_t log2Count) {
        Float sum = 0, n = Float(1u << log2Count);
        for (uint32_t i = 0; i < 1u << log2Count; ++i)
            sum += PieceBounds(segment, Float(i) / n, Float(i + 1) / n).SurfaceArea();
        return sum;
    };
    uint32_t log2Count = 0;
    const auto maxLog2Count = uint32_t(std::clamp(segment.splitDepth, 0, 3));
    for (Float now = surface(0); log2Count < maxLog2Count; ++log2Count) {
        Float next = surface(log2Count + 1);
        if (next > Float(0.7) * now) break;
        now = next;
    }
    for (uint32_t i = 0; i < 1u << log2Count; ++i) {
        Piece p{};
        p.segment = uint32_t(index) & 0x7ffffffu;
        p.log2Count = log2Count & 3u;
        p.index = i & 7u;
        pieces->push_back(p);
    }
}

Bounds3 Curves::PieceBounds(const Segment &segment, Float u0, Float u1) {
    Bounds3 b;
    for (const Point3 &p : segment.curve.Part(u0, u1).p) b = Union(b, p);
    Vector3 half(std::max(WidthAt(segment, u0), WidthAt(segment, u1)) / 2);
    b.low -= half;
    b.high += half;
    return b;
}

Bounds3 Curves::PrimitiveBounds(uint32_t primitive) const {
    const Piece &piece = pieces_[primitive];
    Bounds3 own = PieceBounds(segments_[piece.segment], piece.U0(), piece.U1());
    return isPlaced_ ? own : PlacedBounds(renderFromSegments_, own);
}

Normal3 Curves::RibbonNormal(uint32_t segment, Float u) const {
    const Normal3 &a = normals_[2 * size_t(segment)], &b = normals_[2 * size_t(segment) + 1];
    Float angle = SafeACos(Dot(a, b)), sine = std::sin(angle);
    if (!(sine > 0)) return a;
    return (std::sin((1 - u) * angle) * a + std::sin(u * angle) * b) / sine;
}

/// Nearest-hit search in ray space: origin at the ray's, z along the ray.
struct Curves::Search {
    const Curves &curves;
    const Segment &segment;
    uint32_t segmentIndex;
    Vector3 direction;  ///< of the ray, unit, not in ray space
    Float zMin, zMax;   ///< zMax shrinks with every hit
    Float u = 0, v = 0;
    bool found = false;

    /// Halves the curve `depth` times; then, unless partsAreStraight, until each part is straight.
    void Visit(const CubicBezier &c, Float u0, Float u1, int depth, bool partsAreStraight) {
        if (Misses(c, u0, u1)) return;
        if (depth == 0) {
            depth = partsAreStraight ? 0 : StraightDepth(c);
            partsAreStraight = true;
        }
        if (depth == 0) {
            TestPart(c, u0, u1);
            return;
        }
        CubicBezier first, second;
        c.Halves(&first, &second);
        Float middle = (u0 + u1) / 2;
        Visit(first, u0, middle, depth - 1, partsAreStraight);
        Visit(second, middle, u1, depth - 1, partsAreStraight);
    }

    /// Number of halvings: n parts are within 6 s / (8 n^2) of their chords (s: second difference); sqrt(2) is stock's.
    int StraightDepth(const CubicBezier &c) const {
        Float tolerance = Float(0.05) * std::max(segment.width0, segment.width1);
        Float squaredParts = std::numbers::sqrt2_v<Float> * 6 * c.LargestSecondDifference() / (8 * tolerance);
        if (!(squaredParts >= 4)) return 0;
        return std::min(std::ilogb(std::min(squaredParts, Float(1e9))) / 2, 10);
    }

    bool Misses(const CubicBezier &c, Float u0, Float u1) const {
        Float half = std::max(WidthAt(segment, u0), WidthAt(segment, u1)) / 2;
        Point3 low = Min(Min(c.p[0], c.p[1]), Min(c.p[2], c.p[3]));
        Point3 high = Max(Max(c.p[0], c.p[1]), Max(c.p[2], c.p[3]));
        return low.y > half || high.y < -half || low.x > half || high.x < -half || low.z > zMax || high.z < zMin;
    }

    /// Tests a nearly straight part: the strip between the perpendiculars at its ends.
    void TestPart(const CubicBezier &c, Float u0, Float u1) {
        Vector2 a(c.p[0]), b(c.p[3]);
        if (glm::dot(a, Vector2(c.p[1]) - a) > 0 || glm::dot(b, Vector2(c.p[2]) - b) > 0) return;
        Vector2 chord = b - a;
        Float lengthSquared = glm::dot(chord, chord);
        if (!(lengthSquared > 0)) return;
        Float w = std::clamp(-glm::dot(a, chord) / lengthSquared, Float(0), Float(1));
        Float uHit = Lerp(w, u0, u1), width = WidthAt(segment, uHit);
        if (curves.kind_ == CurveKind::Ribbon) width *= AbsDot(curves.RibbonNormal(segmentIndex, uHit), direction);
        Point3 p = c.At(w);
        if (!(p.z > zMin && p.z < zMax)) return;
        Float distanceSquared = p.x * p.x + p.y * p.y;
        if (!(distanceSquared <= width * width / 4) || !(width > 0)) return;
        Vector3 tangent = c.Derivative(w);
        Float toLeft = p.x * tangent.y - p.y * tangent.x > 0 ? curves.side_ : -curves.side_;
        found = true;
        zMax = p.z;
        u = uHit;
        v = std::clamp(Float(0.5) + toLeft * std::sqrt(distanceSquared) / width, Float(0), Float(1));
    }
};

std::pair<Point3, Vector3> Curves::RayToSegments(const Ray &ray) const {
    if (isPlaced_) return {ray.o, ray.d};
    return {renderFromSegments_.InversePoint(ray.o), renderFromSegments_.InverseVector(ray.d)};
}

std::optional<PrimitiveHit> Curves::Intersect(uint32_t primitive, const Ray &ray, Float tMin) const {
    const Piece &piece = pieces_[primitive];
    const Segment &segment = segments_[piece.segment];
    const auto [o, d] = RayToSegments(ray);
    Float u0 = piece.U0(), u1 = piece.U1(), length = Length(d);
    CubicBezier c = piece.log2Count == 0 ? segment.curve : segment.curve.Part(u0, u1);

    // x along the projected chord gives tight bounds in y.
    Vector3 z = d / length, y = UnitCross(z, c.p[3] - c.p[0]);
    y = Normalize(y - z * Dot(y, z));
    Vector3 x = Cross(y, z);
    for (Point3 &p : c.p) {
        Vector3 r = p - o;
        p = {Dot(r, x), Dot(r, y), Dot(r, z)};
    }
    Search search{*this, segment, piece.segment, z, tMin * length, ray.tMax * length};
    if (search.Misses(c, u0, u1)) return {};

    int cuts = std::clamp(segment.splitDepth, 0, 10) - int(piece.log2Count);
    search.Visit(c, u0, u1, cuts, false);
    if (!search.found) return {};
    Float t = search.zMax / length;
    if (!(t > tMin && t < ray.tMax)) return {};
    return PrimitiveHit{t, search.u, search.v};
}

SurfacePoint Curves::SurfaceOnRay(uint32_t primitive, const PrimitiveHit &hit, const Ray &ray) const {
    const Piece &piece = pieces_[primitive];
    const Segment &segment = segments_[piece.segment];
    const auto [o, d] = RayToSegments(ray);
    Vector3 dpdu = Tangent(segment.curve, hit.u), dpdv;
    Float width = WidthAt(segment, hit.u);
    if (kind_ == CurveKind::Ribbon) {
        Normal3 n = RibbonNormal(piece.segment, hit.u);
        width *= AbsDot(n, d) / Length(d);
        dpdv = side_ * width * UnitCross(n, dpdu);
    } else {
        dpdv = side_ * width * UnitCross(d, dpdu);
        if (kind_ == CurveKind::Cylinder) {
            // v = 0, 1/2, 1 rotates the strip by 90, 0, -90 degrees about the curve.
            Float theta = Pi * (hit.v - Float(0.5));
            dpdv = dpdv * std::cos(theta) - Cross(Normalize(dpdu), dpdv) * (side_ * std::sin(theta));
        }
    }
    SurfacePoint s;
    s.primitive = primitive;
    s.uv = {hit.u, hit.v};
    s.p = o + d * hit.t;
    s.pError = width * errorOfWidth_;
    s.dpdu = dpdu;
    s.dpdv = dpdv;
    if (!isPlaced_) {
        s.pError = renderFromSegments_.PointError(s.p, s.pError);
        s.p = ray(hit.t);
        s.dpdu = renderFromSegments_.Vector(dpdu);
        s.dpdv = renderFromSegments_.Vector(dpdv);
    }
    s.n = Cross(s.dpdu, s.dpdv);
    Float length = Length(s.n);
    s.n = length > 0 ? s.n * (normalSide_ / length) : Normal3(-Normalize(ray.d));
    s.shading = {s.n, s.dpdu, s.dpdv, s.dndu, s.dndv};
    return s;
}

}  // namespace pbrt
