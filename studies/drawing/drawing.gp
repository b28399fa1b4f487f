# Drawings of set-ups and lenses: the axes are of less interest than the lines.
tick_font = 'DejaVu Sans,11'
xlabel_look = "offset 0,0.5"
