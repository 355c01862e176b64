"""The frame of all pages: how templates are filled, and the styles, canvases, charts and player that pages share."""
