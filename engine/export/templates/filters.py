def luma(image):
    """Brightness of colour pixels: (77 R + 150 G + 29 B) / 256, rounded down."""
    red, green, blue = (image[:, :, channel].astype(numpy.int32) for channel in range(3))
    return ((77 * red + 150 * green + 29 * blue) >> 8).astype(numpy.uint8)


def edges(grey, side, middle, least):
    """Sobel (1, 2) or Scharr (3, 10): where the squared gradient reaches `least`; the border repeats the nearest pixel."""
    near = numpy.pad(grey.astype(numpy.int32), 1, mode="edge")
    rows, columns = near[:, 2:] - near[:, :-2], near[2:, :] - near[:-2, :]
    across = side * (rows[:-2] + rows[2:]) + middle * rows[1:-1]
    down = side * (columns[:, :-2] + columns[:, 2:]) + middle * columns[:, 1:-1]
    return numpy.where(across * across + down * down >= least, 255, 0).astype(numpy.uint8)


def threshold(grey, least, bright, dark):
    """One mark for pixels at least so bright, the other for the rest."""
    return numpy.where(grey >= least, bright, dark).astype(numpy.uint8)


def colour(image, hue, width, saturation, dark):
    """Pixels of one hue, counted in 1/256 of a sixth of the circle; saturation in 1/256."""
    red, green, blue = (image[:, :, channel].astype(numpy.int32) for channel in range(3))
    most, least = numpy.maximum(numpy.maximum(red, green), blue), numpy.minimum(numpy.minimum(red, green), blue)
    spread = most - least
    base = numpy.where(most == red, 0, numpy.where(most == green, 512, 1024))
    rise = numpy.where(most == red, green - blue, numpy.where(most == green, blue - red, red - green)) * 256
    # Cut towards 0, as C divides.
    own = base + numpy.sign(rise) * (numpy.abs(rise) // numpy.maximum(spread, 1))
    apart = numpy.abs(own - hue)
    near = (apart <= width) | (numpy.abs(1536 - apart) <= width)
    marked = near & (spread > 0) & (most >= dark) & (spread * 256 >= saturation * most)
    return numpy.where(marked, 255, 0).astype(numpy.uint8)


def chroma(image, rows, columns, left, tolerance):
    """Pixels whose shares of red and blue, in 1/4096, are off those of the strip at the bottom middle."""
    strip = image[image.shape[0] - rows:, left:left + columns].reshape(-1, 3).sum(axis=0, dtype=numpy.int64)
    light = int(strip.sum())
    floor = [(int(strip[channel]) * 4096 + light // 2) // light if light else 4096 // 3 for channel in (0, 2)]
    pixels = image.astype(numpy.int64)
    own = pixels.sum(axis=2)
    off = abs(4096 * pixels[:, :, 0] - floor[0] * own) + abs(4096 * pixels[:, :, 2] - floor[1] * own)
    return numpy.where(off > tolerance * own, 255, 0).astype(numpy.uint8)


def horizon(mask, cleared):
    """Keeps of each row what lies between so many pixels on the left and on the right."""
    columns = numpy.arange(mask.shape[1])
    sides = numpy.asarray(cleared)[:, None]
    return numpy.where((columns < sides) | (columns >= mask.shape[1] - sides), 0, mask).astype(numpy.uint8)


def blur(grey, weights):
    """The mean around each pixel, with these weights in both directions; the border repeats the nearest pixel."""
    radius = len(weights) // 2
    near = numpy.pad(grey.astype(numpy.int64), radius, mode="edge")
    height, width = grey.shape
    sums = sum(weight * near[:, shift:shift + width] for shift, weight in enumerate(weights))
    total = sum(weight * sums[shift:shift + height] for shift, weight in enumerate(weights))
    return ((total + ((1 << (4 * radius)) >> 1)) >> (4 * radius)).astype(numpy.uint8)
