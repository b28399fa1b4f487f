# Look of all figures: fonts, colours, lines. draw_figure.cpp writes the contents of a figure and refers to these
# strings, as @NAME where they are parts of commands.
set border linewidth 1 linecolor '#404040'
set tics nomirror out scale 0.5 textcolor '#202020'
set key noautotitle textcolor '#202020'
set style textbox opaque noborder margins 0.4,0.2

# texts by their roles
base_font = 'DejaVu Sans,11'
title_font = 'DejaVu Sans,14'; title_colour = '#101010'
subtitle_font = 'DejaVu Sans,11'; subtitle_colour = '#404040'
caption_font = 'DejaVu Sans,9'; caption_colour = '#505050'
heading_font = 'DejaVu Sans Bold,11'; heading_colour = '#101010'
panel_font = 'DejaVu Sans Bold,12'; panel_colour = '#101010'
label_font = 'DejaVu Sans,11'; label_colour = '#202020'
note_font = 'DejaVu Sans,10'; note_colour = '#606060'
fine_note_font = 'DejaVu Sans,9'; fine_note_colour = '#707070'
value_on_dark_font = 'DejaVu Sans,9'; value_on_dark_colour = '#f4f4f4'
value_on_bright_font = 'DejaVu Sans,9'; value_on_bright_colour = '#101010'
tick_font = 'DejaVu Sans,10'
legend_font = 'DejaVu Sans,10'

# axes, legend and grid
ticks = "font tick_font"
bar_ticks = "font 'DejaVu Sans,9' scale 0.3 offset -0.8,0"
xticks_look = ""
yticks_look = ""
xlabel_look = "offset 0,0"
ylabel_look = "offset 0.5,0"
legend = "Left reverse samplen 2 font legend_font"
grid = "linecolor '#e4e4e4' linewidth 1 linetype 1"

# heads of arrows and spans
arrow_heads = "head filled size screen 0.007,20"
span_heads = "heads size screen 0.006,20"

# maps
missing = "fillcolor '#b8b8b8' fillstyle solid noborder"
diverging = "defined (0 '#0b3c6f', 0.125 '#2a6fae', 0.25 '#6aacd0', 0.375 '#c3dcea', 0.5 '#f7f7f7', 0.625 '#f9d3bf', 0.75 '#ec9374', 0.875 '#c43b3e', 1 '#6d0720')"
# viridis (S. van der Walt & N. Smith, CC0), sampled at nine points
sequential = "defined (0 '#440154', 0.125 '#482878', 0.25 '#3e4a89', 0.375 '#31688e', 0.5 '#26828e', 0.625 '#1f9e89', 0.75 '#6cce59', 0.875 '#b5de2b', 1 '#fde725')"
grey = "defined (0 '#000000', 1 '#ffffff')"
