# Maps stand closely side by side: small ticks near the axes.
panel_font = 'DejaVu Sans,12'
heading_font = 'DejaVu Sans Bold,13'
tick_font = 'DejaVu Sans,9'
xticks_look = "offset 0,0.4"
yticks_look = "offset 0.6,0"
xlabel_look = "offset 0,0.8"
ylabel_look = "offset 1.2,0"
