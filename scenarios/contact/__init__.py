"""Where wheel and rail touch, how hard, and with which creep forces: depths of contact against exact theory."""
