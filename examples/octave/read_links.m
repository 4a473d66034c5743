% Reads links.csv, and draws the received power of every link over time.
% octave read_links.m links.csv [PICTURE.png]
arguments_ = argv(); file = fopen(arguments_{1}); names = strsplit(fgetl(file), ',');
rows = textscan(file, repmat('%s', 1, numel(names)), 'Delimiter', ','); fclose(file);
column = @(name) rows{strcmp(names, name)};
link = strcat(column('tx'), ' to ', column('rx')); time_s = str2double(column('time_s')); links = unique(link);
power_dbm = str2double(column('power_dbm'));                      % NaN where nothing arrives
printf('%d links, %d lines, at most %.15g dBm\n', numel(links), numel(link), max(power_dbm));
if isempty(available_graphics_toolkits()), return; end
figure('visible', 'off'); hold on;
for k = 1:numel(links), plot(time_s(strcmp(link, links{k})), power_dbm(strcmp(link, links{k}))); end
legend(links); xlabel('time (s)'); ylabel('received power (dBm)');
if numel(arguments_) > 1, print(arguments_{2}, '-dpng'); end
