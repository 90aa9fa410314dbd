#include "simulation/ray_caster.h"

#include <embree3/rtcore.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <new>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "simulation/scene_check.h"

namespace saw_ndt {
namespace {

constexpr std::size_t kPacketSize = 16;
constexpr std::uint32_t kNone = RTC_INVALID_GEOMETRY_ID;

struct DeviceRelease {
  void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
};
struct SceneRelease {
  void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
};
using Device = std::unique_ptr<RTCDeviceTy, DeviceRelease>;
using SceneHandle = std::unique_ptr<RTCSceneTy, SceneRelease>;

/// What a geometry of one of the two scenes that rays are cast into is.
struct Placement {
  std::uint32_t mesh;
  Eigen::Matrix3f normal_matrix;  ///< turns normals of the geometry's frame into the scene's, up to their length
};

Eigen::Matrix3f normalMatrix(const Eigen::Affine3f& T) { return T.linear().inverse().transpose(); }

}  // namespace

class RayCaster::Embree {
 public:
  explicit Embree(const Scene& scene);

  void setTimeSpan(double start_s, double end_s);
  void cast(const Ray* rays, std::size_t count, float max_range_m, RayHit* hits) const;

 private:
  void requireNoError() const;
  SceneHandle newScene(RTCSceneFlags flags, RTCBuildQuality quality) const;
  /// Attaches the triangles of a mesh, moved by T.
  void attachTriangles(RTCScene target, const TriangleMesh& mesh, const Eigen::Affine3f& T) const;
  RTCGeometry attachInstance(RTCScene target, std::uint32_t mesh, unsigned time_steps) const;
  void commit(RTCScene scene) const;
  void readHits(const RTCRayHit16& packet, const std::vector<Placement>& placements, std::size_t count,
                RayHit* hits) const;

  Device device_;
  std::vector<SceneHandle> mesh_scenes_;  ///< null: no instance needs it
  std::vector<std::vector<std::uint16_t>> mesh_materials_;
  SceneHandle standing_;
  std::vector<Placement> standing_placements_;
  SceneHandle moving_;
  std::vector<Placement> moving_placements_;
  std::vector<RTCGeometry> moving_geometries_;  ///< owned by moving_
  std::vector<MovingObject> moving_objects_;
  bool something_moves_ = false;  ///< and has been placed
};

RayCaster::Embree::Embree(const Scene& scene) : moving_objects_(scene.moving_objects) {
  checkScene(scene);
  // Trees are built by one thread: with more, their layout depends on chance, and with it what a ray hits that meets
  // two surfaces at once.
  device_.reset(rtcNewDevice("threads=1"));
  if (!device_) throw std::runtime_error("Embree could not be started");

  // A mesh that stands in one place is part of the scene itself, where rays find it sooner than behind an instance.
  std::vector<std::uint32_t> uses(scene.meshes.size(), 0);
  for (const PlacedObject& object : scene.objects) ++uses[object.mesh];
  std::vector<bool> instanced(scene.meshes.size(), false);
  for (std::size_t i = 0; i < uses.size(); ++i) instanced[i] = uses[i] > 1;
  for (const MovingObject& object : scene.moving_objects) instanced[object.mesh] = true;

  mesh_scenes_.resize(scene.meshes.size());
  for (std::size_t i = 0; i < scene.meshes.size(); ++i) {
    mesh_materials_.push_back(scene.meshes[i].materials);
    if (!instanced[i]) continue;
    mesh_scenes_[i] = newScene(RTC_SCENE_FLAG_ROBUST, RTC_BUILD_QUALITY_HIGH);
    attachTriangles(mesh_scenes_[i].get(), scene.meshes[i], Eigen::Affine3f::Identity());
    commit(mesh_scenes_[i].get());
  }

  standing_ = newScene(RTC_SCENE_FLAG_ROBUST, RTC_BUILD_QUALITY_MEDIUM);
  for (const PlacedObject& object : scene.objects) {
    if (instanced[object.mesh]) {
      const RTCGeometry instance = attachInstance(standing_.get(), object.mesh, 1);
      rtcSetGeometryTransform(instance, 0, RTC_FORMAT_FLOAT4X4_COLUMN_MAJOR, object.T_scene_object.data());
      rtcCommitGeometry(instance);
      standing_placements_.push_back({object.mesh, normalMatrix(object.T_scene_object)});
    } else {
      attachTriangles(standing_.get(), scene.meshes[object.mesh], object.T_scene_object);
      standing_placements_.push_back({object.mesh, Eigen::Matrix3f::Identity()});
    }
  }
  commit(standing_.get());

  moving_ = newScene(static_cast<RTCSceneFlags>(RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_DYNAMIC), RTC_BUILD_QUALITY_LOW);
  for (const MovingObject& object : moving_objects_) {
    moving_geometries_.push_back(attachInstance(moving_.get(), object.mesh, 2));
    moving_placements_.push_back({object.mesh, Eigen::Matrix3f::Identity()});
  }
}

void RayCaster::Embree::requireNoError() const {
  const RTCError error = rtcGetDeviceError(device_.get());
  if (error == RTC_ERROR_NONE) return;
  if (error == RTC_ERROR_OUT_OF_MEMORY) throw std::bad_alloc();
  throw std::runtime_error("Embree failed with error " + std::to_string(error));
}

SceneHandle RayCaster::Embree::newScene(RTCSceneFlags flags, RTCBuildQuality quality) const {
  SceneHandle scene(rtcNewScene(device_.get()));
  if (!scene) requireNoError();
  rtcSetSceneFlags(scene.get(), flags);
  rtcSetSceneBuildQuality(scene.get(), quality);
  return scene;
}

void RayCaster::Embree::attachTriangles(RTCScene target, const TriangleMesh& mesh, const Eigen::Affine3f& T) const {
  const RTCGeometry geometry = rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_TRIANGLE);
  if (!mesh.triangles.empty()) {
    void* vertices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float),
                                             mesh.vertices.size());
    void* indices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                            3 * sizeof(std::uint32_t), mesh.triangles.size());
    if (vertices == nullptr || indices == nullptr) {
      rtcReleaseGeometry(geometry);
      throw std::bad_alloc();
    }
    auto* coordinates = static_cast<float*>(vertices);
    for (const Eigen::Vector3f& vertex : mesh.vertices) {
      const Eigen::Vector3f placed = T * vertex;
      coordinates = std::copy(placed.data(), placed.data() + 3, coordinates);
    }
    auto* corners = static_cast<std::uint32_t*>(indices);
    for (const auto& triangle : mesh.triangles) corners = std::copy(triangle.begin(), triangle.end(), corners);
  }
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(target, geometry);
  rtcReleaseGeometry(geometry);
}

RTCGeometry RayCaster::Embree::attachInstance(RTCScene target, std::uint32_t mesh, unsigned time_steps) const {
  const RTCGeometry instance = rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_INSTANCE);
  rtcSetGeometryInstancedScene(instance, mesh_scenes_[mesh].get());
  rtcSetGeometryTimeStepCount(instance, time_steps);
  rtcAttachGeometry(target, instance);
  rtcReleaseGeometry(instance);
  return instance;
}

void RayCaster::Embree::commit(RTCScene scene) const {
  rtcCommitScene(scene);
  requireNoError();
}

void RayCaster::Embree::setTimeSpan(double start_s, double end_s) {
  if (moving_objects_.empty()) return;
  for (std::size_t i = 0; i < moving_objects_.size(); ++i) {
    unsigned step = 0;
    for (const double stamp_s : {start_s, end_s}) {
      const Eigen::Isometry3d T = moving_objects_[i].T_scene_object(stamp_s);
      checkMovingPose(T, i);
      const Eigen::Affine3f T_scene_object(T.matrix().cast<float>());
      rtcSetGeometryTransform(moving_geometries_[i], step++, RTC_FORMAT_FLOAT4X4_COLUMN_MAJOR, T_scene_object.data());
      // It turns by little during a scan: the normals of its end serve.
      moving_placements_[i].normal_matrix = T_scene_object.linear();
    }
    rtcCommitGeometry(moving_geometries_[i]);
  }
  commit(moving_.get());
  something_moves_ = true;
}

void RayCaster::Embree::readHits(const RTCRayHit16& packet, const std::vector<Placement>& placements, std::size_t count,
                                 RayHit* hits) const {
  for (std::size_t i = 0; i < count; ++i) {
    if (packet.hit.geomID[i] == kNone) continue;
    const std::uint32_t instance = packet.hit.instID[0][i];
    const Placement& placement = placements[instance != kNone ? instance : packet.hit.geomID[i]];
    const Eigen::Vector3f direction(packet.ray.dir_x[i], packet.ray.dir_y[i], packet.ray.dir_z[i]);
    Eigen::Vector3f normal =
        placement.normal_matrix * Eigen::Vector3f(packet.hit.Ng_x[i], packet.hit.Ng_y[i], packet.hit.Ng_z[i]);
    normal *= (normal.dot(direction) > 0.0F ? -1.0F : 1.0F) / normal.norm();
    hits[i].range_m = packet.ray.tfar[i];
    hits[i].normal = normal;
    hits[i].material = mesh_materials_[placement.mesh][packet.hit.primID[i]];
  }
}

void RayCaster::Embree::cast(const Ray* rays, std::size_t count, float max_range_m, RayHit* hits) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  RTCRayHit16 packet = {};
  alignas(64) int valid[kPacketSize];
  for (std::size_t first = 0; first < count; first += kPacketSize) {
    const std::size_t size = std::min(kPacketSize, count - first);
    for (std::size_t i = 0; i < kPacketSize; ++i) {
      const Ray& ray = rays[first + std::min(i, size - 1)];
      valid[i] = i < size ? -1 : 0;
      packet.ray.org_x[i] = ray.origin.x();
      packet.ray.org_y[i] = ray.origin.y();
      packet.ray.org_z[i] = ray.origin.z();
      packet.ray.dir_x[i] = ray.direction.x();
      packet.ray.dir_y[i] = ray.direction.y();
      packet.ray.dir_z[i] = ray.direction.z();
      packet.ray.tnear[i] = 0.0F;
      packet.ray.tfar[i] = max_range_m;
      packet.ray.time[i] = ray.time_share;
      packet.ray.mask[i] = ~0U;
      packet.ray.id[i] = static_cast<unsigned>(i);
      packet.ray.flags[i] = 0;
      packet.hit.geomID[i] = kNone;
      packet.hit.instID[0][i] = kNone;
    }
    std::fill(hits + first, hits + first + size, RayHit());
    rtcIntersect16(valid, standing_.get(), &context, &packet);
    readHits(packet, standing_placements_, size, hits + first);
    if (!something_moves_) continue;
    // What it finds now is nearer than what stands.
    std::fill_n(packet.hit.geomID, kPacketSize, kNone);
    std::fill_n(packet.hit.instID[0], kPacketSize, kNone);
    rtcIntersect16(valid, moving_.get(), &context, &packet);
    readHits(packet, moving_placements_, size, hits + first);
  }
}

RayCaster::RayCaster(const Scene& scene) : embree_(std::make_unique<Embree>(scene)) {}
RayCaster::~RayCaster() = default;
RayCaster::RayCaster(RayCaster&&) noexcept = default;
RayCaster& RayCaster::operator=(RayCaster&&) noexcept = default;

void RayCaster::setTimeSpan(double start_s, double end_s) { embree_->setTimeSpan(start_s, end_s); }

void RayCaster::cast(const Ray* rays, std::size_t count, float max_range_m, RayHit* hits) const {
  embree_->cast(rays, count, max_range_m, hits);
}

}  // namespace saw_ndt
