/* cloud_shim.cc: see cloud_shim.h. */
#include "geom/cloud_shim.h"

#include "base/error.h"
#include "geom/buffer.h"

#include <draco/compression/expert_encode.h>
#include <draco/compression/point_cloud/point_cloud_sequential_decoder.h>

#include <cstring>
#include <new>

awt_status cloud_shim_encode(const int16_t *numbers, uint32_t points, uint32_t components, geom_buffer *out,
                             awt_error *error)
{
    try {
        draco::PointCloud cloud;
        cloud.set_num_points(points);
        draco::GeometryAttribute kind;
        kind.Init(draco::GeometryAttribute::GENERIC, nullptr, static_cast<uint8_t>(components), draco::DT_INT16, false,
                  static_cast<int64_t>(components * sizeof(int16_t)), 0);
        int id = cloud.AddAttribute(kind, true, points);
        cloud.attribute(id)->buffer()->Write(0, numbers, (size_t)points * components * sizeof(int16_t));
        draco::ExpertEncoder encoder(cloud);
        draco::EncoderBuffer encoded;
        encoder.SetEncodingMethod(draco::POINT_CLOUD_SEQUENTIAL_ENCODING);
        encoder.SetSpeedOptions(10, 10);
        if (!encoder.SetAttributePredictionScheme(0, draco::PREDICTION_NONE).ok() ||
            !encoder.EncodeToBuffer(&encoded).ok()) {
            return error_set(error, AWT_BAD_VALUE, "libdraco cannot encode these numbers");
        }
        return geom_buffer_append(out, encoded.data(), encoded.size(), error);
    } catch (const std::bad_alloc &) {
        return error_set(error, AWT_NO_MEMORY, nullptr);
    } catch (...) {
        return error_set(error, AWT_BAD_VALUE, "libdraco cannot encode these numbers");
    }
}

awt_status cloud_shim_decode(const void *bytes, size_t size, uint32_t points, uint32_t components, int16_t *numbers,
                             awt_error *error)
{
    try {
        draco::DecoderBuffer buffer;
        draco::PointCloud cloud;
        draco::PointCloudSequentialDecoder decoder;
        const size_t wanted = (size_t)points * components * sizeof(int16_t);
        buffer.Init(static_cast<const char *>(bytes), size);
        bool decoded = decoder.Decode(draco::DecoderOptions(), &buffer, &cloud).ok() && cloud.num_attributes() == 1;
        const draco::PointAttribute *attribute = decoded ? cloud.attribute(0) : nullptr;
        if (!attribute || cloud.num_points() != points || attribute->data_type() != draco::DT_INT16 ||
            (uint32_t)attribute->num_components() != components || !attribute->is_mapping_identity() ||
            attribute->buffer()->data_size() < wanted) {
            return error_set(error, AWT_BAD_FORMAT, "this is not a point cloud that awtd wrote");
        }
        std::memcpy(numbers, attribute->buffer()->data(), wanted);
        return AWT_OK;
    } catch (const std::bad_alloc &) {
        return error_set(error, AWT_NO_MEMORY, nullptr);
    } catch (...) {
        return error_set(error, AWT_BAD_FORMAT, "this is not a point cloud that awtd wrote");
    }
}
