/* Contrast: stretches the brightness of each frame, so that its darkest pixel becomes black and its brightest white.
 * A threshold or an edge detector behind it then works alike in dim and in bright rooms.
 *
 *     filter("contrast", #{ least_range: 32 });
 *     filter("sobel");
 *
 * Nothing but filter.h is needed. Build it in this folder, natively or for the sandbox:
 *
 *     cc    -O2 -shared -fPIC -I ../filter-api -o contrast.so contrast.c
 *     clang -O2 --target=wasm32 -nostdlib -Wl,--no-entry -I ../filter-api -o contrast.wasm contrast.c
 */
#include "filter.h"

/* Brightness of a colour pixel, 0 to 255: the weights of ITU-R BT.601 in 8 bits, as all filters here use them. */
static uint32_t brightness(const uint8_t *pixel, uint32_t format) {
    if (format == FILTER_GREY) return pixel[0];
    return (77u * pixel[0] + 150u * pixel[1] + 29u * pixel[2]) >> 8;
}

/* The one parameter fits into the pointer that stands for the instance, so nothing must be allocated or freed. A filter
 * that keeps more would point at a struct of its own. */
static int32_t create(const double *values, uint32_t count, void **instance, char *message) {
    (void)count; /* The host passes one value for each parameter, within its range. */
    (void)message;
    *instance = (void *)(uintptr_t)values[0];
    return FILTER_OK;
}

static int32_t process(void *instance, const filter_frame *input, const filter_frame *output, char *message) {
    (void)message;
    const uint32_t least_range = (uint32_t)(uintptr_t)instance;
    const uint32_t channels = input->format == FILTER_GREY ? 1 : 3;
    uint32_t darkest = 255, brightest = 0;
    for (uint32_t y = 0; y < input->height_px; y++) {
        const uint8_t *row = input->pixels + (size_t)y * input->stride_bytes;
        for (uint32_t x = 0; x < input->width_px; x++) {
            const uint32_t grey = brightness(row + (size_t)x * channels, input->format);
            if (grey < darkest) darkest = grey;
            if (grey > brightest) brightest = grey;
        }
    }
    /* A frame without much contrast is left as it is: stretching it would show nothing but noise. */
    const uint32_t range = brightest - darkest;
    const int stretch = brightest > darkest && range >= least_range;
    for (uint32_t y = 0; y < input->height_px; y++) {
        const uint8_t *row = input->pixels + (size_t)y * input->stride_bytes;
        uint8_t *out = output->pixels + (size_t)y * output->stride_bytes;
        for (uint32_t x = 0; x < input->width_px; x++) {
            const uint32_t grey = brightness(row + (size_t)x * channels, input->format);
            out[x] = (uint8_t)(stretch ? (grey - darkest) * 255u / range : grey);
        }
    }
    return FILTER_OK;
}

static void destroy(void *instance) { (void)instance; }

static const filter_parameter parameters[] = {
    {.name = FILTER_TEXT("least_range"),
     .unit = FILTER_TEXT("grey levels"),
     .purpose = FILTER_TEXT("From how many levels between the darkest and the brightest pixel a frame is stretched."),
     .kind = FILTER_WHOLE,
     .min = 1,
     .max = 255,
     .default_value = 32},
};

FILTER_EXPORT(.name = FILTER_TEXT("contrast"), .version = FILTER_TEXT("1.0"),
              .licence = FILTER_TEXT("MIT OR Apache-2.0"),
              .purpose = FILTER_TEXT("Stretches brightness from black to white."),
              .reads = FILTER_RGB | FILTER_GREY | FILTER_BRIGHTNESS, .writes = FILTER_GREY,
              .parameter_count = 1, .parameters = parameters,
              .create = create, .process = process, .destroy = destroy);
