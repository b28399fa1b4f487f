"""Writes the small pictures of this folder, one property each: 7 x 5 px, grey level 10 + 30 i + 5 j (8 bits) or
1000 + 7000 i + 1500 j (16 bits) in column i and row j. Needs numpy, tifffile, imagecodecs and Pillow."""
import numpy
import tifffile
from PIL import Image

row, column = numpy.mgrid[0:5, 0:7]
bytes_ = (10 + 30 * column + 5 * row).astype("u1")
words = (1000 + 7000 * column + 1500 * row).astype("u2")
black = bytes_ > 128
rgb = numpy.stack([bytes_] * 3, -1)
alpha = numpy.where(column % 2, 255, 128).astype("u1")
inks = numpy.dstack([255 - rgb, numpy.zeros_like(bytes_)])


def write(name, image, **options):
    tifffile.imwrite(name + ".tif", numpy.ascontiguousarray(image), metadata=None, software="", **options)


turned = {1: bytes_, 2: bytes_[:, ::-1], 3: bytes_[::-1, ::-1], 4: bytes_[::-1], 5: bytes_.T,
          6: numpy.rot90(bytes_, 1), 7: bytes_[::-1, ::-1].T, 8: numpy.rot90(bytes_, -1)}
for orientation, image in turned.items():
    write(f"orientation_{orientation}", image, extratags=[(274, "H", 1, orientation, True)])
exif = Image.Exif()
exif[274] = 6
Image.fromarray(numpy.ascontiguousarray(turned[6])).save("orientation_6.png", exif=exif)
Image.fromarray(numpy.ascontiguousarray(turned[6])).save("orientation_6.jpg", quality=100, exif=exif)

write("big_endian", words, byteorder=">")
write("bigtiff", words, bigtiff=True)
write("tiled", words, tile=(16, 16))
write("predictor", words, compression="lzw", predictor=True)
for method in ("zstd", "lzma", "packbits", "jpeg2000", "webp"):
    write("compression_" + method, rgb if method == "webp" else bytes_, compression=method)
for bits in (2, 4, 10, 12, 14):
    write(f"bits_{bits}", bytes_ >> (8 - bits) if bits < 8 else words >> (16 - bits), bitspersample=bits)
Image.fromarray(black).save("bits_1.tif")  # without the entry BitsPerSample
Image.fromarray(black).save("bits_1_group4.tif", compression="group4")
Image.fromarray(black).save("bits_1.png")
write("bits_1_white_is_zero", ~black, photometric="miniswhite", bitspersample=1)
write("white_is_zero_8", 255 - bytes_, photometric="miniswhite")
write("white_is_zero_12", 4095 - (words >> 4), photometric="miniswhite", bitspersample=12)
write("white_is_zero_16", 65535 - words, photometric="miniswhite")

write("float_16", (words / 65535.0).astype("f2"))
write("float_32", (words / 65535.0).astype("f4"))
write("int_8", (bytes_.astype(int) - 100).astype("i1"))
write("int_16", (words.astype(int) - 30000).astype("i2"))
write("uint_32", words.astype("u4") * 60000)
write("uint_64", words.astype("u8"))
write("complex", words.astype("c8"))

palette = Image.fromarray(numpy.arange(35).reshape(5, 7).astype("u1"), "P")
colours = numpy.zeros((256, 3), "u1")
colours[:35] = rgb.reshape(35, 3)
palette.putpalette(colours.ravel().tolist())
for ending in ("tif", "png", "gif"):
    palette.save("palette." + ending)
write("rgb", rgb, photometric="rgb")
write("rgb_planar", numpy.moveaxis(rgb, -1, 0), photometric="rgb", planarconfig="separate")
write("rgba", numpy.dstack([rgb, alpha]), photometric="rgb", extrasamples=["unassalpha"])
write("grey_alpha", numpy.dstack([bytes_, alpha]), photometric="minisblack", extrasamples=["unassalpha"])
Image.fromarray(numpy.dstack([bytes_, alpha]), "LA").save("grey_alpha.png")
Image.fromarray(words).save("grey_16.png")
Image.fromarray(bytes_).save("grey.jpg", quality=100)
Image.fromarray(rgb).convert("YCbCr").save("ycbcr.tif")
write("inks", inks, photometric="separated")
write("inks_tiled", inks, photometric="separated", tile=(16, 16))
write("inks_16_tiled", inks.astype("u2") * 257, photometric="separated", tile=(16, 16))
write("inks_planar", numpy.moveaxis(inks, -1, 0), photometric="separated", planarconfig="separate")
Image.fromarray(inks, "CMYK").save("inks_jpeg.tif", compression="jpeg", quality=100)
write("inks_five_tiled", numpy.dstack([inks, inks[..., :1]]), photometric="separated", tile=(16, 16),
      extrasamples=["unspecified"])
write("channels_seven", numpy.stack([bytes_ + k for k in range(7)], -1), photometric="minisblack",
      extrasamples=["unspecified"] * 6)
with tifffile.TiffWriter("pages_3.tif") as pages:
    for page in range(3):
        pages.write(bytes_ + page, metadata=None)
mask = numpy.ones((5, 7), "f4")
mask[:2] = numpy.nan
write("mask_nan", mask)
